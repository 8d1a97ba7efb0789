//! Rigid-body poses: one type everywhere, shared with the collision library.

use glam::{DMat3, DQuat, DVec3};

/// The pose of one frame in another: a unit quaternion and a translation in metres, in f64.
pub type Pose = glamx::DPose3;

/// Roll-pitch-yaw about fixed axes, as URDF writes it: R = Rz(yaw) · Ry(pitch) · Rx(roll), radians.
#[must_use]
pub fn rotation_from_rpy(roll: f64, pitch: f64, yaw: f64) -> DQuat {
    (DQuat::from_rotation_z(yaw) * DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll)).normalize()
}

/// Reads `x y z qx qy qz qw`, the order of our files and configurations. The quaternion is normalised.
///
/// Returns `None` where a number is not finite or the quaternion is (nearly) zero.
#[must_use]
pub fn pose_from_array(v: [f64; 7]) -> Option<Pose> {
    let rotation = DQuat::from_xyzw(v[3], v[4], v[5], v[6]);
    let length = rotation.length();
    if !v.iter().all(|x| x.is_finite()) || !length.is_finite() || length < 1e-9 {
        return None;
    }
    Some(Pose::from_parts(DVec3::new(v[0], v[1], v[2]), rotation / length))
}

/// Writes `x y z qx qy qz qw`.
#[must_use]
pub fn pose_to_array(pose: &Pose) -> [f64; 7] {
    let (t, r) = (pose.translation, pose.rotation);
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w]
}

/// The rotation vector of a unit quaternion, of length at most π (logarithm of SO(3)).
#[must_use]
pub fn log_so3(rotation: DQuat) -> DVec3 {
    let r = if rotation.w < 0.0 { -rotation } else { rotation };
    let v = DVec3::new(r.x, r.y, r.z);
    let sine = v.length();
    // 2·atan2(s, w)/s tends to 2/w; the series keeps full precision where the quotient would not.
    let scale = if sine < 1e-9 { 2.0 / r.w } else { 2.0 * sine.atan2(r.w) / sine };
    v * scale
}

/// The unit quaternion of a rotation vector (exponential of so(3)).
#[must_use]
pub fn exp_so3(v: DVec3) -> DQuat {
    let half = 0.5 * v.length();
    let scale = if half < 1e-9 { 0.5 - half * half / 12.0 } else { half.sin() / half * 0.5 };
    DQuat::from_xyzw(v.x * scale, v.y * scale, v.z * scale, half.cos()).normalize()
}

/// J such that d log(R)/dt = J·ω, where ω is the angular velocity of R in the *fixed* (left) frame.
///
/// This is the inverse left Jacobian of SO(3): 1 − ½V + (1/θ² − (1 + cos θ)/(2θ sin θ))V², v = log R, θ = |v|, V = skew(v).
/// For ω in the moving (right) frame use its transpose.
#[must_use]
pub fn log_so3_jacobian(v: DVec3) -> DMat3 {
    let theta_squared = v.length_squared();
    let theta = theta_squared.sqrt();
    let coefficient = if theta < 1e-4 {
        1.0 / 12.0 + theta_squared / 720.0
    } else {
        1.0 / theta_squared - (1.0 + theta.cos()) / (2.0 * theta * theta.sin())
    };
    let skew = skew(v);
    DMat3::IDENTITY - skew * 0.5 + skew * skew * coefficient
}

/// The matrix of the cross product: skew(a)·b = a × b.
#[must_use]
pub fn skew(a: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_and_exponential_are_inverse() {
        for v in [DVec3::ZERO, DVec3::new(1e-12, 0.0, 0.0), DVec3::new(0.3, -1.2, 2.0), DVec3::new(0.0, 3.1, 0.0)] {
            assert!((log_so3(exp_so3(v)) - v).length() < 1e-12, "{v}");
        }
    }

    #[test]
    fn the_jacobian_of_the_logarithm_agrees_with_finite_differences() {
        let v = DVec3::new(0.4, -1.1, 0.7);
        let step = 1e-6;
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let forward = log_so3(exp_so3(axis * step) * exp_so3(v));
            let backward = log_so3(exp_so3(-axis * step) * exp_so3(v));
            let numeric = (forward - backward) / (2.0 * step);
            assert!((numeric - log_so3_jacobian(v) * axis).length() < 1e-8);
        }
    }
}
