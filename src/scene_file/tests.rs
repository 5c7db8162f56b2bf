use tangency_core::{BodyDef, SceneDef, Shape};

use super::*;

#[test]
fn probe() {
    for text in [
        "dt = 0.1\nbodies = 3",
        "dt = 0.1\n[[bodies]]\nname = \"a\"\nmasss = 3",
        "dt = 0.1\n[[bodies]]\nname = \"a\"\nmass = \"heavy\"",
        "[[bodies]]\nname = \"a\"\nshapes = [{ circel = { radius = 1.0 } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ circle = { radus = 1.0 } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ circle = { } }]",
        "[[bodies]]\nname = \"a\"\nkind = \"dynamik\"",
        "[[bodies]]\nname = \"a\"\nposition = [1, 2, 3]",
        "[[bodies]]\nname = \"a\"\nposition = [1]",
        "[[bodies]]\nname = \"a\"\nmask = -1",
        "[[joints]]\nname = \"a\"\nbodies = [\"a\", \"b\"]\n[joints.kind]\nrevolute = {}",
        "[[joints]]\nname = \"a\"\nbodies = [\"a\", \"b\"]\n[joints.kind]\nrevolute = { anchor = [0,0], motor = { spid = 1 } }",
        "[[joints]]\nname = \"a\"\nbodies = [\"a\", \"b\"]\n[joints.kind.revolute]\nanchor = [0,0]\nmotor = { speed = 1, max = -2.0 }",
        "[[joints]]\nname = \"a\"\nbodies = [\"a\", \"b\"]\n[joints.kind]\n",
        "contact_model = \"gapp\"", "contact_model = 3", "contact_model = { velocity = {} }", "[stabilisation]\njoints = { baumgarte = { fraction = \"x\" }}",
        "dt = ", "dt = 0.1.2", "[[bodies]\n", "dt = 1\ndt = 2", "dt = -1", "dtt = 1",
    ] {
        let error = match parse_scene(text, SceneFormat::Toml) {
            Ok(def) => SceneFileError::refused({ let Err(e) = Scene::new(&def) else { println!("accepted {text}"); continue }; e }, text, SceneFormat::Toml),
            Err(error) => error,
        };
        println!("{error}");
    }
    for text in [
        "{\"dt\": 0.1,\n\"bodies\": 3}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"masss\": 3}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"mass\": \"heavy\"}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"mass\": -2}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"shapes\": [{\"circel\": {\"radius\": 1}}]}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"shapes\": [{\"circle\": {\n\"radus\": 1}}]}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"shapes\": [{\"circle\": {}}]}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"kind\": \"dynamik\"}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"position\": [1,2,3]}]}",
        "{\"dt\": 0.1,\n\"bodies\": [{\"name\": \"a\",\n\"position\": [1]}]}",
        "{\"dt\": 0.1,\n", "{\"dt\": 0.1,}", "{\"dt\": 0.1} x", "{\"dt\": 1e999}", "[]", "3", "",
    ] {
        let error = match parse_scene(text, SceneFormat::Json) {
            Ok(def) => SceneFileError::refused({ let Err(e) = Scene::new(&def) else { println!("accepted {text}"); continue }; e }, text, SceneFormat::Json),
            Err(error) => error,
        };
        println!("{error}");
    }
}
