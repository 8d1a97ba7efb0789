//! The attributes and elements of an SRDF that are read.

use crate::scene::reading::known::{Children, Known};

/// Attributes beside these are told, and elements whose names are like these.
pub(super) const KNOWN: Known = Known {
    attributes: &[
        ("position", &["xyz", "rpy", "wxyz", "xyzw"]),
        ("gripper", &["name", "clearance"]),
        ("handle", &["name", "clearance", "approaching_direction"]),
        ("contact", &["name"]),
        ("link", &["name", "index"]),
        ("group_state", &["name", "group"]),
        ("joint", &["name", "value"]),
        ("end_effector", &["name", "group", "parent_link", "parent_group"]),
        ("disable_collisions", &["link1", "link2", "reason"]),
        ("enable_collisions", &["link1", "link2", "reason"]),
        ("disable_default_collisions", &["link", "reason"]),
    ],
    children: &[
        Children {
            of: "robot",
            read: &[
                "gripper",
                "handle",
                "contact",
                "group_state",
                "end_effector",
                "disable_collisions",
                "enable_collisions",
                "disable_default_collisions",
            ],
            other: &["group", "virtual_joint", "passive_joint", "joint_property"],
            all: false,
        },
        Children { of: "gripper", read: &["position", "link"], other: &[], all: false },
        Children { of: "handle", read: &["position", "link", "mask", "mask_complement"], other: &[], all: false },
        Children { of: "contact", read: &["link", "point", "shape", "triangle"], other: &[], all: false },
        Children { of: "group_state", read: &["joint"], other: &[], all: false },
    ],
};
