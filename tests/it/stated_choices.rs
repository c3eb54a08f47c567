//! What a scene states itself no tolerance decides; what a list of effects names and the scene cannot feed is said; tables know what a scene states.

use mmxrt::physics::sun_disc::DiscRule;
use mmxrt::progress::unwatched;
use mmxrt::scene::{Fixed, Models, Scene, SunModel, Thermal};
use mmxrt::study::{self, Choice, Decision, Effect, Plan, Request};

use crate::cli::run;
use crate::scenes::{SITE, SQUARE, SQUARE_OBJ, replaced};
use crate::scratch::Scratch;

/// Text after `[mars]`, after `[sun]`, and for `[thermal]`.
fn site(mars: &str, sun: &str, thermal: &str) -> String {
    replaced(SITE, &[("[mars]\n", &format!("[mars]\n{mars}\n")), ("[sun]\n", &format!("[sun]\n{sun}\n"))])
        + &format!("[thermal]\n{thermal}\n")
}

fn planned(scene: &Scene, choice: Choice, tolerance: f64) -> (Models, Plan) {
    let (models, _, plan) = study::decide(scene, &Request { choice, tolerance }, &unwatched).unwrap();
    (models, plan)
}

fn effect<'p>(plan: &'p Plan, key: &str) -> &'p Effect {
    plan.effects.iter().find(|effect| effect.key == key).unwrap()
}

/// A key, the effect that it decides, and what the models then have; at a tolerance that alone would decide the other way.
#[test]
fn a_stated_key_decides_whatever_the_tolerance() {
    // What keeps nothing of its own, and what keeps all.
    let (loose, tight) = (1e3, 1e-12);
    let disc = |points| SunModel::Disc(DiscRule::of_count(points).unwrap());
    type Has<'a> = &'a dyn Fn(&Models) -> bool;
    let conducting = "model = \"conduction\"\nsteps = 5\ninertia = 50.0\nperiod_s = 27554.0";
    let resting = "model = \"equilibrium\"\ninertia = 50.0\nperiod_s = 27554.0";
    let cases: [(&str, [&str; 3], f64, Decision, Has); 14] = [
        ("sun-disc", ["", "points = 1", ""], tight, Decision::Dropped, &|m| m.sun == SunModel::Point),
        ("sun-disc", ["", "points = 3", ""], tight, Decision::Kept, &|m| m.sun == disc(3)),
        ("sun-disc", ["", "points = 37", ""], loose, Decision::Kept, &|m| m.sun == disc(37)),
        ("eclipse", ["eclipse = false", "", ""], tight, Decision::Dropped, &|m| !m.eclipses),
        ("eclipse", ["eclipse = true", "", ""], loose, Decision::Kept, &|m| m.eclipses),
        ("mars-glow", ["heat = false", "", ""], tight, Decision::Dropped, &|m| !m.mars_heat),
        ("mars-glow", ["heat = true", "", ""], loose, Decision::Kept, &|m| m.mars_heat),
        ("mars-light", ["model = \"off\"", "", ""], tight, Decision::Dropped, &|m| {
            m.mars_light != Models::default().mars_light
        }),
        ("mars-light", ["model = \"near_field\"", "", ""], loose, Decision::Kept, &|m| {
            m.mars_light == Models::default().mars_light
        }),
        ("mars-shadows", ["points = 3", "", ""], loose, Decision::Kept, &|m| m.mars_shadows == DiscRule::of_count(3)),
        ("heat", ["", "", "model = \"off\""], tight, Decision::Dropped, &|m| m.thermal == Thermal::Off),
        ("heat", ["", "", "model = \"equilibrium\""], loose, Decision::Kept, &|m| m.thermal == Thermal::Equilibrium),
        ("thermal-inertia", ["", "", conducting], loose, Decision::Kept, &|m| m.conduction == Some(5)),
        ("thermal-inertia", ["", "", resting], tight, Decision::Dropped, &|m| m.conduction.is_none()),
    ];
    let scratch = Scratch::new();
    for (key, [mars, sun, thermal], tolerance, decision, has) in cases {
        let scene = scratch.scene(&site(mars, sun, thermal).replace("[1.0]", "[3.4]"));
        let what = format!("{key}: {mars}{sun}{thermal}");
        let (models, plan) = planned(&scene, Choice::Auto, tolerance);
        let found = effect(&plan, key);
        assert!(has(&models), "{what}: {models:?}");
        assert_eq!(found.decision, decision, "{what}");
        assert!(found.stated.as_ref().is_some_and(|key| key.contains('.')), "{what}");
        // It tells its bound all the same, and where the scene leaves it out that is no part of the plan's sum; the Sun's disc has a tolerance of its own.
        assert!(key == "eclipse" || found.bound.is_some(), "{what}");
        let dropped = plan
            .effects
            .iter()
            .filter(|e| e.decision == Decision::Dropped && e.stated.is_none() && e.key != "sun-disc");
        let sum: f64 = dropped.map(|effect| effect.bound.unwrap().lit).sum();
        assert!((plan.dropped.unwrap().lit - sum).abs() <= 1e-12 * sum, "{what}: {:?} {sum}", plan.dropped);
        // And in `full`.
        assert!(has(&planned(&scene, Choice::Full, 1e-3).0), "{what}");
        // Without the key the tolerance decides.
        let mut parts = scene.into_parts();
        parts.models = Models { fixed: Fixed::default(), thermal: Thermal::Equilibrium, ..Models::default() };
        let (models, plan) = planned(&parts.check().unwrap(), Choice::Auto, tolerance);
        assert!(plan.effects.iter().all(|effect| effect.stated.is_none()), "{what}");
        assert!(tolerance == tight || models.sun == SunModel::Point, "{what}");
    }
}

#[test]
fn steps_of_a_day_count_where_the_plan_conducts() {
    let scratch = Scratch::new();
    let scene = scratch.scene(&site("", "", "steps = 7\ninertia = 50.0\nperiod_s = 27554.0"));
    assert_eq!(scene.models.conduction, Some(7));
    assert_eq!(planned(&scene, Choice::Full, 1e-3).0.conduction, Some(7));
    assert_eq!(planned(&scene, Choice::Auto, 1e3).0.conduction, None);
}

#[test]
fn who_names_effects_decides_and_is_told() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", site("eclipse = true", "points = 1", ""));
    scratch.write("dark.toml", replaced(SITE, &[("[mars]\nposition_m = [9.4e6, 12000.0, 0.0]\n", "")]));
    let out = scratch.argument("out");
    let said = |scene: &str, model: &str| {
        let scene = scratch.argument(scene);
        let (code, _, err) = run(&["simulate", &scene, "-o", &out, "--model", model, "--force"]);
        assert_eq!(code, 0, "{err}");
        err
    };
    // Against the scene, both ways.
    let err = said("scene.toml", "sun-disc,heat");
    assert!(err.contains("leaves out eclipse, which the scene states (`mars.eclipse`)"), "{err}");
    assert!(err.contains("has sun-disc, which the scene leaves out (`sun.points`)"), "{err}");
    // What the scene cannot feed, each by its name; what it can is not mentioned.
    let err = said("dark.toml", "sunlight,eclipse,mars-light,mars-shadows,mars-glow,thermal-inertia,bodies,sun-disc");
    for (key, why) in [
        ("eclipse", "no Mars"),
        ("mars-light", "no Mars"),
        ("mars-shadows", "no Mars"),
        ("mars-glow", "no Mars"),
        ("thermal-inertia", "no thermal inertia above 0 is stated"),
        ("bodies", "no body besides Mars"),
    ] {
        let line = err.lines().find(|line| line.contains(&format!("asks for {key},")));
        assert!(line.is_some_and(|line| line.contains(why)), "{key}: {err}");
    }
    assert!(!err.contains("asks for sunlight") && !err.contains("asks for sun-disc"), "{err}");
    // Nothing to say.
    let err = said("scene.toml", "eclipse");
    assert!(!err.contains("--model"), "{err}");
}

#[test]
fn conduction_without_what_it_needs_is_said() {
    let scratch = Scratch::new();
    scratch.write("scene.toml", site("", "", "model = \"conduction\"\nperiod_s = 27554.0"));
    let (code, said, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 0 && said.contains("thermal.model: heat is conducted, but no material stores any"), "{said} {err}");
    scratch.write("scene.toml", site("", "", "model = \"conduction\"\ninertia = 50.0"));
    let (code, said, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 1 && err.contains("thermal.model") && err.contains("period_s"), "{said} {err}");
    // Steps of what is not conducted.
    scratch.write("scene.toml", site("", "", "model = \"equilibrium\"\nsteps = 5\ninertia = 50.0\nperiod_s = 27554.0"));
    let (code, said, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 0 && said.contains("thermal.steps: counts for nothing"), "{said} {err}");
}

#[test]
fn eclipses_are_one_choice() {
    let body =
        "[[bodies]]\nname = \"moon\"\nposition_m = [0.0, 3e8, 0.0]\nradius_m = 1e5\nalbedo = 0.1\neclipse = false\n";
    let scratch = Scratch::new();
    let text = site("eclipse = true", "", "") + body;
    let line = 1 + text.lines().position(|line| line == "eclipse = false").unwrap();
    scratch.write("scene.toml", text);
    let (code, _, err) = run(&["inspect", &scratch.argument("scene.toml")]);
    assert!(code == 1 && err.contains(&format!("scene.toml:{line}:")) && err.contains("one choice"), "{err}");
}

/// What is stated, and what is not, comes back from a written scene and from DART.
#[test]
#[cfg_attr(not(feature = "sqlite"), ignore = "SKIPPED: needs the feature sqlite")]
fn what_is_stated_is_written() {
    let scratch = Scratch::new();
    let stated = site(
        "eclipse = false\nheat = false\npoints = 1\nmodel = \"near_field\"",
        "points = 1",
        "model = \"equilibrium\"",
    );
    let all = Fixed { thermal: true, mars_light: true, sun: true, eclipses: true, mars_shadows: true, mars_heat: true };
    for (text, fixed) in [(stated, all), (SITE.to_owned(), Fixed::default())] {
        let scene = scratch.scene(&text);
        assert_eq!(scene.models.fixed, fixed);
        let [from, to, dart, back] =
            ["scene.toml", "to/to.toml", "dart", "back/back.toml"].map(|name| scratch.argument(name));
        for arguments in [
            ["convert", &from, &to, "--force"],
            ["convert", &from, &dart, "--force"],
            ["convert", &dart, &back, "--force"],
        ] {
            let (code, _, err) = run(&arguments);
            assert_eq!(code, 0, "{arguments:?}: {err}");
        }
        for written in ["to/to.toml", "back/back.toml"] {
            let file = mmxrt::formats::scene_toml::read(&scratch.join(written), &unwatched).unwrap();
            assert_eq!(file.scene.models, scene.models, "{written}");
        }
        let (code, said, err) = run(&["convert", "--diff", &from, &to]);
        assert_eq!(code, 0, "{said} {err}");
    }
    // A choice that only one of them makes is a difference.
    scratch.write("a.toml", site("", "points = 1", ""));
    scratch.write("b.toml", site("", "", ""));
    let (code, said, _) = run(&["convert", "--diff", &scratch.argument("a.toml"), &scratch.argument("b.toml")]);
    assert!(code == 1 && said.contains("sun.points"), "{said}");
}

#[test]
fn a_table_serves_no_scene_with_another_floor() {
    let scratch = Scratch::new();
    scratch.write("square.obj", SQUARE_OBJ);
    let with = |floor: &str| {
        replaced(SQUARE, &[("model = \"off\"", floor), ("[1.0]", "[10.0]"), ("bands]\n", "bands]\nlight = \"heat\"\n")])
    };
    let floors = [("none", ""), ("low", "floor_k = 45.5"), ("high", "floor_k = 120.0")];
    for (name, floor) in floors {
        scratch.write(&format!("{name}.toml"), with(floor));
        let (scene, table) = (scratch.argument(&format!("{name}.toml")), scratch.argument(&format!("{name}.npz")));
        let (code, _, err) = run(&["solve", &scene, "-o", &table]);
        assert_eq!(code, 0, "{err}");
    }
    for (of, _) in floors {
        for (to, _) in floors {
            let (scene, table) = (scratch.argument(&format!("{to}.toml")), scratch.argument(&format!("{of}.npz")));
            let (code, _, err) =
                run(&["integrate", &scene, "--table", &table, "-o", &scratch.argument("out"), "--force"]);
            assert_eq!(code == 0, of == to, "{of} {to}: {err}");
            assert!(
                of == to || (err.contains("thermal.floor_k") && err.contains(&format!("{of}.npz"))),
                "{of} {to}: {err}"
            );
        }
    }
}

#[test]
fn a_table_that_was_solved_otherwise_than_a_scene_states_warns() {
    let scratch = Scratch::new();
    scratch.write("one.toml", site("", "points = 1", ""));
    scratch.write("seven.toml", site("", "points = 7", ""));
    scratch.write("any.toml", site("", "", ""));
    let [one, seven, any, table, out] =
        ["one.toml", "seven.toml", "any.toml", "t.npz", "out"].map(|name| scratch.argument(name));
    let (code, _, err) = run(&["solve", &one, "-o", &table]);
    assert_eq!(code, 0, "{err}");
    for (scene, warns) in [(one, false), (seven, true), (any, false)] {
        let (code, _, err) = run(&["integrate", &scene, "--table", &table, "-o", &out, "--force"]);
        assert_eq!(code, 0, "{err}");
        assert_eq!(err.contains("solved otherwise than the scene states by `sun.points`"), warns, "{scene}: {err}");
    }
}
