//! The attributes and elements of a URDF that decide where solids are and how they move; and parts without solids.

use crate::scene::reading::error::SceneError;
use crate::scene::reading::known::{Children, Known};
use crate::scene::reading::xml::{Xml, elements};
use roxmltree::Node;

/// All others are told.
pub(super) const KNOWN: Known = Known {
    attributes: &[
        ("origin", &["xyz", "rpy", "quat_xyzw"]),
        ("box", &["size"]),
        ("sphere", &["radius"]),
        ("cylinder", &["radius", "length"]),
        ("capsule", &["radius", "length"]),
        ("mesh", &["filename", "scale"]),
        ("parent", &["link"]),
        ("child", &["link"]),
        ("axis", &["xyz"]),
        ("limit", &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"]),
        ("mimic", &["joint", "multiplier", "offset"]),
        ("mass", &["value"]),
        ("joint", &["name", "type"]),
        ("link", &["name", "type"]),
    ],
    children: &[
        Children { of: "robot", read: &["joint", "link"], other: &[], all: false },
        Children {
            of: "joint",
            read: &["origin", "parent", "child", "axis", "limit", "mimic"],
            // Of simulators and controllers; soft limits of `safety_controller` are for controllers that stop in front of the limits.
            other: &["calibration", "dynamics", "safety_controller", "gazebo", "hardwareInterface", "compliance"],
            all: true,
        },
        Children {
            of: "link",
            read: &["collision", "inertial"],
            // How a link looks is read elsewhere. `collision_checking` is pinocchio's.
            other: &["visual", "collision_checking", "contact", "gazebo", "sensor", "material", "audio_source"],
            all: true,
        },
        Children {
            of: "collision",
            read: &["origin", "geometry"],
            other: &["contact_coefficients", "material", "surface", "verbose", "max_contacts"],
            all: true,
        },
        Children { of: "geometry", read: &["box", "sphere", "cylinder", "capsule", "mesh"], other: &[], all: true },
        Children { of: "inertial", read: &["origin", "mass"], other: &["inertia"], all: true },
        Children { of: "origin", read: &[], other: &[], all: true },
        Children { of: "axis", read: &[], other: &[], all: true },
        Children { of: "limit", read: &[], other: &[], all: true },
        Children { of: "mimic", read: &[], other: &[], all: true },
        Children { of: "mesh", read: &[], other: &["material"], all: true },
    ],
};

/// A part without collision shapes: nothing can touch it. Frames alone (a world, a floor's edge) are fine where they are no robot.
pub(super) fn tell_shapeless(xml: &Xml<'_>, root: Node<'_, '_>, may_be_frames: bool) -> Option<SceneError> {
    let visuals = elements(root, "link").filter(|link| elements(*link, "visual").next().is_some()).count();
    let (message, hint) = match visuals {
        0 if may_be_frames => return None,
        0 => ("has no collision shapes: it is never in the way".to_owned(), "give its links <collision> elements"),
        _ => {
            let links = if visuals == 1 { "1 link has".to_owned() } else { format!("{visuals} links have") };
            let message = format!("has no collision shapes ({links} a <visual> alone): it is never in the way");
            (message, "what is to be solid needs a <collision> of its own")
        }
    };
    Some(xml.error(root, message).hint(hint))
}
