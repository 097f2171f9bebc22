//! Joints that open or slip, in words.

use crate::mechanics::friction::YieldingJoint;

/// Motion of a joint in words.
pub(super) fn motion_in_words(joint: &YieldingJoint) -> String {
    // Hinges are named by the edge about which the joint turns.
    let opens = match (joint.opens_intrados, joint.opens_extrados) {
        (true, true) => Some("parts at both edges".to_owned()),
        (true, false) => Some("opens with its hinge at the extrados".to_owned()),
        (false, true) => Some("opens with its hinge at the intrados".to_owned()),
        (false, false) => None,
    };
    let slips = joint.slips_towards;
    let slips = slips.map(|edge| format!("slips, its right side towards the {}", edge.name()));
    let does: Vec<String> = opens.into_iter().chain(slips).collect();
    does.join(" and ")
}
