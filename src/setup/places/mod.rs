//! Where things stand so that a robot can take them: gripper poses within reach (`reach`), inverse kinematics (`arm`), collisions of whole
//! configurations (`world`), where the table is (`table`), how a hand takes an object (`taking`), where objects lie (`layout`).

pub(crate) mod arm;
pub(crate) mod layout;
pub(crate) mod reach;
pub(crate) mod table;
pub(crate) mod taking;
pub(crate) mod world;
