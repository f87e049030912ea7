//! Shorthands in general form, and steps resolved into motions and loads.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use subrope::scene::{
    Component, Load, LoadTarget, Motion, MotionPath, MotionTarget, Prescription, Program, ProgramStep, Ramp, Scene,
    expand,
};

const HEAD: &str = r#"
title = "test"
[strand]
radius = 1.0
length = 60.0
surface_angle = 30.0
[element]
formulation = "hex8"
[law]
kind = "isotropic"
E = 1.0
nu = 0.3
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[constraint]]
name = "AXIS_Z"
set = "AXIS"
components = { uz = 0.5 }
"#;

fn scene(steps: &str) -> Scene {
    let steps = steps.replace("[[step]]", "[[step]]\nincrements = { fixed = 1 }");
    Scene::from_toml("test.toml", &format!("{HEAD}{steps}")).unwrap_or_else(|e| panic!("{}", e.plain()))
}

fn motion(step: &ProgramStep, name: &str, component: Component) -> MotionPath {
    let targets = [MotionTarget::Point(name.into()), MotionTarget::Constraint(name.into())];
    let found: Vec<&Motion> =
        step.motions.iter().filter(|m| targets.contains(&m.target) && m.component == component).collect();
    assert_eq!(found.len(), 1, "{name} {component:?}");
    found[0].path.clone()
}

fn load<'a>(step: &'a ProgramStep, target: &LoadTarget, component: Component) -> &'a Load {
    step.loads.iter().find(|l| l.target == *target && l.component == component).unwrap()
}

#[test]
fn bend_expands_to_rotations_and_a_free_end() {
    let scene = scene("[[step]]\nname = \"b\"\n[step.bend]\nangle = 90.0\naxis = \"y\"");
    let general = expand(&scene.step[0], Some(60.0));
    assert!(general.bend.is_none());
    let [a, b] = general.prescribe.as_slice() else { panic!("two entries") };
    assert_eq!((a.point.as_deref(), b.point.as_deref()), (Some("END_A"), Some("END_B")));
    assert_eq!(a.ry, Some(Prescription::to(90.0)));
    assert_eq!(b.ry, Some(Prescription::Ramp(Ramp::To(-90.0))));
    assert_eq!(b.uz, Some(Prescription::free()));
    assert!(a.uz.is_none() && a.rx.is_none() && b.rx.is_none());
}

#[test]
fn expansion_is_the_general_form_a_user_could_write() {
    let short = scene("[[step]]\nname = \"s\"\n[step.tension]\nelongation = 0.02\ntwist = \"free\"");
    let long = scene("[[step]]\nname = \"s\"\n[[step.prescribe]]\npoint = \"END_B\"\nuz = 1.2\nrz = \"free\"");
    assert_eq!(Program::new(&short), Program::new(&long));
    let short = scene("[[step]]\nname = \"s\"\n[step.bend]\nangle = 30.0\nends = \"circle\"");
    let long = scene(
        "[[step]]\nname = \"s\"\n[[step.prescribe]]\npoint = \"END_A\"\nrx = 30.0\n[[step.prescribe]]\n\
         point = \"END_B\"\nrx = -30.0\nuz = { arc = { length = 60.0, angle = 30.0 } }",
    );
    assert_eq!(Program::new(&short), Program::new(&long));
}

#[test]
fn angles_become_radians_and_the_rest_is_held() {
    let scene = scene("[[step]]\nname = \"b\"\n[step.bend]\nangle = 90.0");
    let program = Program::new(&scene);
    let step = &program.steps[0];
    assert_eq!(step.motions.len(), 13);
    let half = std::f64::consts::FRAC_PI_2;
    assert!((motion(step, "END_A", Component::Rx).value(1.0, 0.0).unwrap() - half).abs() < 1e-15);
    assert!((motion(step, "END_B", Component::Rx).value(0.5, 0.0).unwrap() + half / 2.0).abs() < 1e-15);
    assert_eq!(motion(step, "END_B", Component::Uz), MotionPath::Free);
    assert_eq!(motion(step, "END_B", Component::Ux).value(0.7, 9.0), Some(0.0));
    assert_eq!(motion(step, "AXIS_Z", Component::Uz).value(0.5, 0.0), Some(0.25));
}

#[test]
fn the_circle_keeps_the_arc_length() {
    let scene = scene(
        "[[step]]\nname = \"half\"\n[step.bend]\nangle = 45.0\nends = \"circle\"\n[[step]]\nname = \"full\"\n\
         [step.bend]\nangle = 90.0\nends = \"circle\"\n[[step]]\nname = \"hold\"\n[[step]]\nname = \"back\"\n\
         [step.bend]\nangle = 0.0\nends = \"circle\"",
    );
    let program = Program::new(&scene);
    let exact = |degrees: f64| {
        let theta = degrees.to_radians();
        if theta == 0.0 { 0.0 } else { 60.0 * (theta.sin() / theta - 1.0) }
    };
    let cases = [
        (0, 0.5, 22.5),
        (0, 1.0, 45.0),
        (1, 0.0, 45.0),
        (1, 0.5, 67.5),
        (1, 1.0, 90.0),
        (2, 0.3, 90.0),
        (3, 0.5, 45.0),
        (3, 1.0, 0.0),
    ];
    for (step, fraction, degrees) in cases {
        let found = motion(&program.steps[step], "END_B", Component::Uz).value(fraction, f64::NAN).unwrap();
        assert!((found - exact(degrees)).abs() < 1e-12, "step {step} at {fraction}: {found} for {degrees} deg");
    }
    let small = motion(&program.steps[0], "END_B", Component::Uz).value(1e-6, 0.0).unwrap();
    let theta = 45e-6_f64.to_radians();
    assert!((small / (-10.0 * theta * theta) - 1.0).abs() < 1e-11);
}

#[test]
fn histories_start_where_the_step_before_ended() {
    let scene = scene(
        "[[step]]\nname = \"1\"\n[[step.prescribe]]\npoint = \"END_B\"\nuz = [[0.25, 2.0], [0.5, -1.0]]\n\
         ux = \"free\"\n[[step]]\nname = \"2\"\n[[step.prescribe]]\npoint = \"END_B\"\nuz = 3.0\nux = 1.0",
    );
    let program = Program::new(&scene);
    let first = motion(&program.steps[0], "END_B", Component::Uz);
    for (fraction, value) in [(0.0, 0.0), (0.125, 1.0), (0.25, 2.0), (0.375, 0.5), (0.5, -1.0), (1.0, -1.0)] {
        assert_eq!(first.value(fraction, 0.0), Some(value), "at {fraction}");
    }
    assert_eq!(motion(&program.steps[1], "END_B", Component::Uz).value(0.5, 77.0), Some(1.0));
    // Free before: from whatever was reached.
    assert_eq!(motion(&program.steps[1], "END_B", Component::Ux).value(0.5, 7.0), Some(4.0));
    assert_eq!(motion(&program.steps[1], "AXIS_Z", Component::Uz).value(0.0, 0.0), Some(0.5));
}

#[test]
fn forces_stay_until_they_are_changed() {
    let scene = scene(
        "[[step]]\nname = \"pull\"\n[step.tension]\nforce = 100.0\n[[step.traction]]\nsurface = \"LATERAL\"\ntx = 2.0\n\
         [[step]]\nname = \"twist\"\n[step.tension]\ntwist = 10.0\n[[step.nodal_force]]\nset = \"AXIS\"\nfy = 3.0\n\
         [[step]]\nname = \"release\"\n[step.tension]\nforce = 0.0",
    );
    let program = Program::new(&scene);
    let pull = LoadTarget::Point("END_B".into());
    let at =
        |step: usize, fraction: f64| load(&program.steps[step], &pull, Component::Uz).path.value(fraction, f64::NAN);
    assert_eq!([at(0, 0.5), at(0, 1.0), at(1, 0.0), at(1, 1.0), at(2, 0.25)], [50.0, 100.0, 100.0, 100.0, 75.0]);
    assert_eq!(motion(&program.steps[1], "END_B", Component::Uz), MotionPath::Free);
    let traction = load(&program.steps[2], &LoadTarget::Surface("LATERAL".into()), Component::Ux);
    assert_eq!(traction.path.value(0.5, f64::NAN), 2.0);
    let nodal = load(&program.steps[1], &LoadTarget::NodesTotal("AXIS".into()), Component::Uy);
    assert_eq!(nodal.path.value(0.5, f64::NAN), 1.5);
}

#[test]
fn a_standing_force_on_a_held_component_is_an_error() {
    let steps = "[[step]]\nname = \"pull\"\n[step.tension]\nforce = 100.0\n[[step]]\nname = \"hold\"\n\
                 [step.tension]\nelongation = 0.1";
    let answer = Scene::from_toml("test.toml", &format!("{HEAD}{steps}")).unwrap_err().plain();
    assert!(answer.contains("prescribes `uz` of \"END_B\" while `fz` of an earlier step acts"), "{answer}");
}
