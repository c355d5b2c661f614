use super::*;

#[test]
fn every_scene_makes_a_clip() {
    for scene in SCENES {
        let clip = scene.clip(&scene.difficulty()).unwrap();
        assert_eq!(clip.frame(1).unwrap().size(), clip.size());
    }
}
