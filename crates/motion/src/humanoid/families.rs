//! The joints of the families of rigs in use: for each the whole tree, and the roles that must be found.

use super::{Humanoid, Role, Side};

/// A tree as lines of names, each indented by two spaces more than its parent.
fn tree(text: &str) -> (Vec<&str>, Vec<Option<usize>>) {
    let (mut names, mut parents, mut open) = (Vec::new(), Vec::new(), Vec::<(usize, usize)>::new());
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let depth = line.len() - line.trim_start().len();
        while open.last().is_some_and(|(d, _)| *d >= depth) {
            open.pop();
        }
        parents.push(open.last().map(|(_, joint)| *joint));
        open.push((depth, names.len()));
        names.push(line.trim());
    }
    (names, parents)
}

/// The same limbs on both sides: `{}` stands for the side.
fn both(text: &str, [left, right]: [&str; 2]) -> String {
    text.replace("{}", left) + &text.replace("{}", right)
}

/// Checks the roles: those of the trunk in the order hips, neck, head, then for each side clavicle, upper arm, forearm, hand, thigh,
/// shin, foot, toe. An empty name is a role that the rig does not have.
#[track_caller]
fn check(text: &str, trunk: [&str; 3], limbs: [&str; 8], sides: [&str; 2]) {
    let (names, parents) = tree(text);
    let figure = Humanoid::new(&names, &parents);
    let name = |role: Role| figure.get(role).map_or("", |joint| names[joint]);
    assert_eq!([Role::Hips, Role::Neck, Role::Head].map(name), trunk);
    for (side, word) in Side::BOTH.into_iter().zip(sides) {
        let of_side = [
            Role::Clavicle(side),
            Role::UpperArm(side),
            Role::Forearm(side),
            Role::Hand(side),
            Role::Thigh(side),
            Role::Shin(side),
            Role::Foot(side),
            Role::Toe(side),
        ];
        let expected = limbs.map(|limb| limb.replace("{}", word));
        assert_eq!(of_side.map(name), expected.each_ref().map(String::as_str));
    }
}

#[test]
fn mixamo() {
    let sides = ["Left", "Right"];
    let arms = "        mixamorig:{}Shoulder\n          mixamorig:{}Arm\n            mixamorig:{}ForeArm\n              mixamorig:{}Hand\n                \
        mixamorig:{}HandThumb1\n                mixamorig:{}HandIndex1\n";
    let legs = "  mixamorig:{}UpLeg\n    mixamorig:{}Leg\n      mixamorig:{}Foot\n        mixamorig:{}ToeBase\n          mixamorig:{}Toe_End\n";
    let text = "mixamorig:Hips\n  mixamorig:Spine\n    mixamorig:Spine1\n      mixamorig:Spine2\n        mixamorig:Neck\n          mixamorig:Head\n            \
        mixamorig:HeadTop_End\n"
        .to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs = ["{}Shoulder", "{}Arm", "{}ForeArm", "{}Hand", "{}UpLeg", "{}Leg", "{}Foot", "{}ToeBase"];
    let of = |name: &str| format!("mixamorig:{name}");
    let limbs = limbs.map(of);
    let limbs = limbs.each_ref().map(String::as_str);
    check(&text, ["mixamorig:Hips", "mixamorig:Neck", "mixamorig:Head"], limbs, sides);
}

#[test]
fn mixamo_in_letters_of_one_size() {
    let sides = ["Left", "Right"];
    let arms = "      {}Shoulder\n        {}Arm\n          {}ForeArm\n            {}Hand\n";
    let legs = "  {}UpLeg\n    {}Leg\n      {}Foot\n        {}ToeBase\n          {}Toe_End\n";
    let text = "Hips\n  Spine\n    Spine1\n      Neck\n        Head\n          HeadTop_End\n".to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs = ["{}Shoulder", "{}Arm", "{}ForeArm", "{}Hand", "{}UpLeg", "{}Leg", "{}Foot", "{}ToeBase"];
    for write in [str::to_uppercase, str::to_lowercase] {
        let trunk = ["Hips", "Neck", "Head"].map(write);
        let sides = sides.map(write);
        let limbs = limbs.map(write);
        let text = write(&text);
        let side = sides.each_ref().map(String::as_str);
        check(&text, trunk.each_ref().map(String::as_str), limbs.each_ref().map(String::as_str), side);
    }
}

#[test]
fn joints_at_the_end_of_a_limb_are_not_the_limb() {
    let sides = ["l", "r"];
    let arms = "        clavicle_{}\n          upperarm_{}\n            shoulder_{}\n            lowerarm_{}\n              elbow_{}\n              hand_{}\n                \
        wrist_{}\n";
    let legs = "    thigh_{}\n      hip_{}\n      calf_{}\n        knee_{}\n        foot_{}\n          heel_{}\n          ball_{}\n";
    let text = "root\n  pelvis\n    spine_01\n      spine_02\n        neck_01\n          head\n".to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs =
        ["clavicle_{}", "upperarm_{}", "lowerarm_{}", "hand_{}", "thigh_{}", "calf_{}", "foot_{}", "ball_{}"];
    check(&text, ["pelvis", "neck_01", "head"], limbs, sides);
    // Numbers do not make the end of a limb its start.
    check(
        &text.replace("lowerarm_", "lowerarm01_"),
        ["pelvis", "neck_01", "head"],
        limbs.map(|limb| if limb == "lowerarm_{}" { "lowerarm01_{}" } else { limb }),
        sides,
    );
    // The control: where the elbow carries the hand, it is the forearm.
    let carries =
        text.replace("lowerarm_", "no_").replace(" hand_", "   hand_").replace(" wrist_", "   wrist_");
    check(
        &carries,
        ["pelvis", "neck_01", "head"],
        limbs.map(|limb| if limb == "lowerarm_{}" { "elbow_{}" } else { limb }),
        sides,
    );
}

#[test]
fn a_heel_that_carries_the_foot_is_the_ankle() {
    let sides = ["L", "R"];
    let arms = "      {}_Collar\n        {}_Shoulder\n          {}_Elbow\n            {}_Wrist\n";
    let legs = |foot: &str| format!("  {{}}_Hip\n    {{}}_Knee\n{foot}");
    let trunk = "Pelvis\n  Spine1\n    Spine2\n      Neck\n        Head\n";
    let of = |foot: &str| trunk.to_owned() + &both(arms, sides) + &both(&legs(foot), sides);
    let limbs =
        |foot, toe| ["{}_Collar", "{}_Shoulder", "{}_Elbow", "{}_Wrist", "{}_Hip", "{}_Knee", foot, toe];
    for (foot, limbs) in [
        ("      {}_Heel\n        {}_Foot\n", limbs("{}_Heel", "{}_Foot")),
        ("      {}_Heel\n        {}_Toe\n", limbs("{}_Heel", "{}_Toe")),
        // The controls: a heel at the end of the foot.
        ("      {}_Foot\n        {}_Heel\n        {}_Toe\n", limbs("{}_Foot", "{}_Toe")),
        ("      {}_Ankle\n        {}_Heel\n        {}_Foot\n", limbs("{}_Ankle", "{}_Foot")),
    ] {
        check(&of(foot), ["Pelvis", "Neck", "Head"], limbs, sides);
    }
}

#[test]
fn human_ik() {
    let sides = ["Left", "Right"];
    let arms = "          Character1_{}Shoulder\n            Character1_{}Arm\n              Character1_{}ArmRoll\n              Character1_{}ForeArm\n                \
        Character1_{}Hand\n";
    let legs = "    Character1_{}UpLeg\n      Character1_{}Leg\n        Character1_{}Foot\n          Character1_{}ToeBase\n";
    let text = "Character1_Reference\n  Character1_Hips\n    Character1_Spine\n      Character1_Spine1\n        Character1_Spine2\n          \
        Character1_Neck\n            Character1_Head\n"
        .to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs = [
        "Character1_{}Shoulder",
        "Character1_{}Arm",
        "Character1_{}ForeArm",
        "Character1_{}Hand",
        "Character1_{}UpLeg",
        "Character1_{}Leg",
        "Character1_{}Foot",
        "Character1_{}ToeBase",
    ];
    check(&text, ["Character1_Hips", "Character1_Neck", "Character1_Head"], limbs, sides);
}

#[test]
fn biped_of_3ds_max() {
    let sides = ["L", "R"];
    let limbs = [
        "Bip01 {} Clavicle",
        "Bip01 {} UpperArm",
        "Bip01 {} Forearm",
        "Bip01 {} Hand",
        "Bip01 {} Thigh",
        "Bip01 {} Calf",
        "Bip01 {} Foot",
        "Bip01 {} Toe0",
    ];
    let legs =
        "Bip01 {} Thigh\n  Bip01 {} Calf\n    Bip01 {} Foot\n      Bip01 {} Toe0\n        Bip01 {} Toe0Nub\n";
    let arms = "Bip01 {} Clavicle\n  Bip01 {} UpperArm\n    Bip01 {} Forearm\n      Bip01 {} Hand\n        Bip01 {} Finger0\n      Bip01 {} ForeTwist\n";
    let indented = |text: &str, by: usize| {
        both(text, sides).lines().fold(String::new(), |all, line| all + &" ".repeat(by) + line + "\n")
    };
    // Arms hang on the neck, and legs on the lowest joint of the spine.
    let trunk = "Bip01\n  Bip01 Footsteps\n  Bip01 Pelvis\n    Bip01 Spine\n";
    let old = trunk.to_owned()
        + &indented(legs, 6)
        + "      Bip01 Spine1\n        Bip01 Neck\n"
        + &indented(arms, 10)
        + "          Bip01 Head\n            Bip01 HeadNub\n";
    check(&old, ["Bip01 Spine", "Bip01 Neck", "Bip01 Head"], limbs, sides);
    // Arms hang on the chest, and legs on the pelvis.
    let new = trunk.to_owned()
        + "      Bip01 Spine1\n"
        + &indented(arms, 8)
        + "        Bip01 Neck\n          Bip01 Head\n"
        + &indented(legs, 4);
    check(&new, ["Bip01 Pelvis", "Bip01 Neck", "Bip01 Head"], limbs, sides);
}

#[test]
fn mannequin_of_unreal() {
    let sides = ["l", "r"];
    let arms = "        clavicle_{}\n          clavicle_out_{}\n          upperarm_{}\n            upperarm_twist_01_{}\n            lowerarm_{}\n              \
        lowerarm_twist_01_{}\n              hand_{}\n                index_metacarpal_{}\n";
    let legs = "    thigh_{}\n      thigh_twist_01_{}\n      calf_{}\n        calf_twist_01_{}\n        foot_{}\n          ball_{}\n";
    let text = "root\n  pelvis\n    spine_01\n      spine_02\n        spine_03\n          neck_01\n            neck_02\n              head\n"
        .to_owned()
        + &both(&arms.replace("        clavicle_{}", "          clavicle_{}"), sides)
        + &both(legs, sides)
        + "  ik_foot_root\n    ik_foot_l\n    ik_foot_r\n  ik_hand_root\n    ik_hand_gun\n      ik_hand_l\n      ik_hand_r\n";
    let limbs =
        ["clavicle_{}", "upperarm_{}", "lowerarm_{}", "hand_{}", "thigh_{}", "calf_{}", "foot_{}", "ball_{}"];
    check(&text, ["pelvis", "neck_01", "head"], limbs, sides);
}

#[test]
fn daz() {
    let sides = ["l", "r"];
    // Genesis 8.
    let arms = "          {}Collar\n            {}ShldrBend\n              {}ShldrTwist\n                {}ForearmBend\n                  {}ForearmTwist\n                    \
        {}Hand\n";
    let legs = "    {}ThighBend\n      {}ThighTwist\n        {}Shin\n          {}Foot\n            {}Metatarsals\n              {}Toe\n                {}BigToe\n";
    let text = "hip\n  pelvis\n".to_owned()
        + &both(legs, sides)
        + "  abdomenLower\n    abdomenUpper\n      chestLower\n        chestUpper\n          neckLower\n            neckUpper\n              head\n"
        + &both(arms, sides);
    let limbs =
        ["{}Collar", "{}ShldrBend", "{}ForearmBend", "{}Hand", "{}ThighBend", "{}Shin", "{}Foot", "{}Toe"];
    check(&text, ["hip", "neckLower", "head"], limbs, sides);
    // Genesis 9.
    let arms = "            {}_shoulder\n              {}_upperarm\n                {}_upperarmtwist1\n                {}_forearm\n                  {}_hand\n";
    let legs = "    {}_thigh\n      {}_thightwist1\n      {}_shin\n        {}_foot\n          {}_toes\n";
    let text = "hip\n  pelvis\n".to_owned()
        + &both(legs, sides)
        + "  spine1\n    spine2\n      spine3\n        spine4\n          neck1\n            neck2\n              head\n"
        + &both(&arms.replace("            {}_shoulder", "          {}_shoulder"), sides);
    let limbs =
        ["{}_shoulder", "{}_upperarm", "{}_forearm", "{}_hand", "{}_thigh", "{}_shin", "{}_foot", "{}_toes"];
    check(&text, ["hip", "neck1", "head"], limbs, sides);
}

#[test]
fn rigify() {
    let sides = ["L", "R"];
    let arms = "        DEF-shoulder.{}\n          DEF-upper_arm.{}\n            DEF-upper_arm.{}.001\n              DEF-forearm.{}\n                DEF-forearm.{}.001\n                  \
        DEF-hand.{}\n                    DEF-f_index.01.{}\n        DEF-breast.{}\n";
    let legs = "  DEF-pelvis.{}\n  DEF-thigh.{}\n    DEF-thigh.{}.001\n      DEF-shin.{}\n        DEF-shin.{}.001\n          DEF-foot.{}\n            DEF-toe.{}\n";
    let trunk = "DEF-spine\n  DEF-spine.001\n    DEF-spine.002\n      DEF-spine.003\n        DEF-spine.004\n          DEF-spine.005\n            DEF-spine.006\n              \
        DEF-jaw\n";
    let figure = trunk.to_owned() + &both(arms, sides) + &both(legs, sides);
    let limbs = [
        "DEF-shoulder.{}",
        "DEF-upper_arm.{}",
        "DEF-forearm.{}",
        "DEF-hand.{}",
        "DEF-thigh.{}",
        "DEF-shin.{}",
        "DEF-foot.{}",
        "DEF-toe.{}",
    ];
    let expected = ["DEF-spine", "DEF-spine.004", "DEF-spine.006"];
    check(&figure, expected, limbs, sides);
    // With the controls of the whole rig.
    let controls = "root\n  torso\n    hips\n    chest\n    neck\n      head\n  hand_ik.L\n  foot_ik.L\n  ORG-spine.006\n  upper_arm_fk.L\n  thigh_tweak.L\n";
    check(&(controls.to_owned() + &figure), expected, limbs, sides);
    // The metarig, as many files without controls have it.
    let limbs = limbs.map(|limb| limb.trim_start_matches("DEF-"));
    check(&figure.replace("DEF-", ""), ["spine", "spine.004", "spine.006"], limbs, sides);
}

#[test]
fn vroid_and_the_bones_of_vrm() {
    let sides = ["L", "R"];
    let arms = "        J_Bip_{}_Shoulder\n          J_Bip_{}_UpperArm\n            J_Bip_{}_LowerArm\n              J_Bip_{}_Hand\n        J_Sec_{}_Bust1\n";
    let legs = "  J_Bip_{}_UpperLeg\n    J_Bip_{}_LowerLeg\n      J_Bip_{}_Foot\n        J_Bip_{}_ToeBase\n";
    let text = "J_Bip_C_Hips\n  J_Bip_C_Spine\n    J_Bip_C_Chest\n      J_Bip_C_UpperChest\n        J_Bip_C_Neck\n          J_Bip_C_Head\n            J_Sec_Hair1_01\n            \
        J_Adj_L_FaceEye\n"
        .to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs = [
        "J_Bip_{}_Shoulder",
        "J_Bip_{}_UpperArm",
        "J_Bip_{}_LowerArm",
        "J_Bip_{}_Hand",
        "J_Bip_{}_UpperLeg",
        "J_Bip_{}_LowerLeg",
        "J_Bip_{}_Foot",
        "J_Bip_{}_ToeBase",
    ];
    check(&text, ["J_Bip_C_Hips", "J_Bip_C_Neck", "J_Bip_C_Head"], limbs, sides);
    // The standard names that VRM files assign.
    let sides = ["left", "right"];
    let arms = "        {}Shoulder\n          {}UpperArm\n            {}LowerArm\n              {}Hand\n";
    let legs = "  {}UpperLeg\n    {}LowerLeg\n      {}Foot\n        {}Toes\n";
    let text = "hips\n  spine\n    chest\n      upperChest\n        neck\n          head\n            leftEye\n            jaw\n".to_owned()
        + &both(arms, sides)
        + &both(legs, sides);
    let limbs =
        ["{}Shoulder", "{}UpperArm", "{}LowerArm", "{}Hand", "{}UpperLeg", "{}LowerLeg", "{}Foot", "{}Toes"];
    check(&text, ["hips", "neck", "head"], limbs, sides);
}

#[test]
fn miku_miku_dance() {
    let sides = ["左", "右"];
    let arms = "        {}肩P\n          {}肩\n            {}腕\n              {}腕捩\n                {}ひじ\n                  {}手捩\n                    {}手首\n                      \
        {}親指０\n";
    let legs = "      {}足\n        {}ひざ\n          {}足首\n            {}つま先\n";
    let begin = "全ての親\n  センター\n    グルーブ\n";
    let upper = "      上半身\n        上半身2\n          首\n            頭\n              両目\n";
    let arms = &both(
        &arms.replace("        {}肩P", "          {}肩P").replace("          {}肩\n", "            {}肩\n"),
        sides,
    );
    let text = begin.to_owned()
        + upper
        + arms
        + "      下半身\n"
        + &both(
            &legs
                .replace("      {}足\n", "        {}足\n")
                .replace("        {}ひざ", "          {}ひざ")
                .replace("          {}足首", "            {}足首")
                .replace("            {}つま先", "              {}つま先"),
            sides,
        )
        + "  左足ＩＫ\n    左つま先ＩＫ\n  右足ＩＫ\n    右つま先ＩＫ\n";
    let limbs = ["{}肩", "{}腕", "{}ひじ", "{}手首", "{}足", "{}ひざ", "{}足首", "{}つま先"];
    check(&text, ["グルーブ", "首", "頭"], limbs, sides);
    // Newer models have copies of the legs that carry the surface.
    let copies =
        both("        {}足D\n          {}ひざD\n            {}足首D\n              {}足先EX\n", sides)
            + "  左足ＩＫ";
    let copies = text.replace("  左足ＩＫ", &copies);
    let (names, parents) = tree(&copies);
    let figure = Humanoid::new(&names, &parents);
    assert_eq!(figure.get(Role::Shin(Side::Left)).map(|j| names[j]), Some("左ひざD"));
    // English standard names.
    let sides = ["L", "R"];
    let arms = "        shoulder_{}\n          arm_{}\n            arm twist_{}\n              elbow_{}\n                wrist twist_{}\n                  wrist_{}\n                    \
        thumb1_{}\n";
    let legs = "      leg_{}\n        knee_{}\n          ankle_{}\n            toe_{}\n";
    let text = "mother\n  center\n    upper body\n      upper body2\n        neck\n          head\n            eye_L\n".to_owned()
        + &both(arms, sides)
        + "    lower body\n"
        + &both(legs, sides)
        + "  leg IK_L\n    toe IK_L\n";
    let limbs = ["shoulder_{}", "arm_{}", "elbow_{}", "wrist_{}", "leg_{}", "knee_{}", "ankle_{}", "toe_{}"];
    check(&text, ["center", "neck", "head"], limbs, sides);
}

#[test]
fn a_tree_without_such_names_has_no_roles() {
    let (names, parents) = tree("root\n  tentacle1\n    tentacle2\n  wheel_L\n  wheel_R\n");
    assert_eq!(Humanoid::new(&names, &parents).roles().count(), 0);
}
