//! The JSON Schemas of `schema/` are those of the types, and written files follow them. `VTEX_BLESS=1 cargo
//! test --test all schema::` writes them anew.

use schemars::{Schema, schema_for};
use serde_json::{Value, json};
use std::path::Path;
use vtex::analyze::{AnalyzeParams, Exemplar, Limits, analyze};
use vtex::library::Library;
use vtex::scene::{Scene, SynthParams};
use vtex::segment::{MasksFile, Regions, Segmenter, masks_to_bytes};
use vtex::synth::{reconstruct, synthesize};
use vtex::tune::{TuneParams, TunedWeights, tune};

/// File name, schema, and the values of the fields `format` and `version`.
fn schemas() -> [(&'static str, Schema, &'static str, u32); 4] {
    [
        ("library", schema_for!(Library), Library::FORMAT, Library::VERSION),
        ("scene", schema_for!(Scene), Scene::FORMAT, Scene::VERSION),
        ("weights", schema_for!(TunedWeights), TunedWeights::FORMAT, TunedWeights::VERSION),
        ("masks", MasksFile::json_schema(), "vtex-masks", 1),
    ]
}

/// The schema as it is published.
fn published(schema: Schema, format: &str, version: u32) -> Value {
    let mut value = schema.to_value();
    value["properties"]["format"]["const"] = json!(format);
    value["properties"]["version"]["const"] = json!(version);
    // Files have this field, documents in memory do not.
    value["properties"]["sha256"] = json!({
        "description": "SHA-256 of the file's bytes before this field, in hexadecimal. A file is replaced \
                        without asking only while it is right.",
        "type": "string",
    });
    value
}

#[test]
fn committed_schemas_are_current() {
    for (name, schema, format, version) in schemas() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("schema/{name}.schema.json"));
        let text = serde_json::to_string_pretty(&published(schema, format, version)).unwrap() + "\n";
        if std::env::var_os("VTEX_BLESS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(committed == text, "{} is out of date: run with VTEX_BLESS=1", path.display());
    }
}

/// Whether a value follows a schema, as far as the keywords go that these schemas use; any other
/// keyword is an error, so that nothing goes unchecked.
fn check(value: &Value, schema: &Value, root: &Value, at: &str) -> Result<(), String> {
    let Some(schema) = schema.as_object() else {
        return if schema == &json!(true) { Ok(()) } else { Err(format!("{at}: nothing is allowed here")) };
    };
    let number = |limit: &Value| limit.as_f64().unwrap();
    let length = value.as_array().map_or(0, Vec::len) as f64;
    for (keyword, rule) in schema {
        let ok = match keyword.as_str() {
            "$schema" | "$defs" | "title" | "description" | "format" | "default" => true,
            "type" => {
                let named = |name: &Value| match name.as_str().unwrap() {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    "number" => value.is_number(),
                    "integer" => value.is_i64() || value.is_u64(),
                    other => panic!("{at}: type {other}"),
                };
                rule.as_array().map_or_else(|| named(rule), |names| names.iter().any(named))
            }
            "const" => value == rule,
            "pattern" => {
                let text = value.as_str().unwrap_or_default();
                match rule.as_str().unwrap() {
                    "^#[0-9a-f]{6}$" => {
                        let digits = text.strip_prefix('#').unwrap_or_default();
                        digits.len() == 6 && digits.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'))
                    }
                    "^[MmLlHhVvCcZz0-9eE+., -]*$" => {
                        text.chars().all(|c| c.is_ascii_digit() || "MmLlHhVvCcZzeE+., -".contains(c))
                    }
                    other => panic!("{at}: pattern {other}"),
                }
            }
            "contentEncoding" => rule == "base64" && decoded(value).is_some(),
            "contentMediaType" => {
                rule == "image/png" && decoded(value).is_some_and(|png| png.starts_with(b"\x89PNG\r\n"))
            }
            "minimum" => value.as_f64().is_none_or(|v| v >= number(rule)),
            "maximum" => value.as_f64().is_none_or(|v| v <= number(rule)),
            "minItems" => length >= number(rule),
            "maxItems" => length <= number(rule),
            "required" => rule.as_array().unwrap().iter().all(|k| value.get(k.as_str().unwrap()).is_some()),
            "additionalProperties" => {
                assert_eq!(rule, &json!(false));
                value.as_object().is_none_or(|v| v.keys().all(|k| schema["properties"].get(k).is_some()))
            }
            "properties" => {
                for (key, rule) in rule.as_object().unwrap() {
                    if let Some(inner) = value.get(key) {
                        check(inner, rule, root, &format!("{at}.{key}"))?;
                    }
                }
                true
            }
            "items" => {
                for (i, inner) in value.as_array().into_iter().flatten().enumerate() {
                    check(inner, rule, root, &format!("{at}[{i}]"))?;
                }
                true
            }
            "anyOf" => rule.as_array().unwrap().iter().any(|one| check(value, one, root, at).is_ok()),
            "oneOf" => {
                rule.as_array().unwrap().iter().filter(|one| check(value, one, root, at).is_ok()).count() == 1
            }
            "$ref" => {
                let target = root.pointer(rule.as_str().unwrap().trim_start_matches('#'));
                check(value, target.unwrap_or_else(|| panic!("{at}: {rule} leads nowhere")), root, at)?;
                true
            }
            other => panic!("{at}: keyword {other} is not known to this test"),
        };
        if !ok {
            return Err(format!("{at}: against {keyword} {rule}"));
        }
    }
    Ok(())
}

/// The bytes that a string holds in base64.
fn decoded(value: &Value) -> Option<Vec<u8>> {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.decode(value.as_str()?).ok()
}

/// A library, a scene, weights, masks and a reconstruction of a small crop, with their schemas.
fn written() -> Vec<(Value, Value)> {
    let photo = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/exemplars/terrazzo.png");
    let crop = image::open(photo).unwrap().crop_imm(100, 100, 120, 100);
    let mut bytes = std::io::Cursor::new(Vec::new());
    crop.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let exemplar = Exemplar::from_bytes(bytes.get_ref(), "crop.png", &Limits::default()).unwrap();
    let masks = Regions.segment(&exemplar.image, &()).unwrap();
    let masks = masks_to_bytes("crop.masks.json".as_ref(), "regions", 120, 100, &masks, &[]).unwrap();
    let library = analyze(&exemplar, &Regions, &AnalyzeParams::default(), &()).unwrap();
    let params = SynthParams { width: 150, height: 90, ..SynthParams::default() };
    let scene = synthesize(&library, &params, &()).unwrap();
    let params = TuneParams { synth: params, seeds: 1, evaluations: 10 };
    let tuned = tune(&library, &params, &()).unwrap();
    let files = [library.to_json(), scene.to_json(), tuned.to_json(), masks, reconstruct(&library).to_json()];
    let schemas = schemas().map(|(_, schema, format, version)| published(schema, format, version));
    let order = [0, 1, 2, 3, 1].map(|i| schemas[i].clone());
    files.iter().map(|bytes| serde_json::from_slice(bytes).unwrap()).zip(order).collect()
}

#[test]
fn what_is_written_follows_its_schema() {
    for (value, schema) in written() {
        assert_eq!(check(&value, &schema, &schema, "$"), Ok(()), "{}", value["format"]);
    }
}

/// Objects in a value, as JSON pointers.
fn objects(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            found.push(at.to_owned());
            fields.iter().for_each(|(key, inner)| objects(inner, &format!("{at}/{key}"), found));
        }
        Value::Array(items) => {
            // The first item of a list stands for all.
            items.iter().take(1).for_each(|inner| objects(inner, &format!("{at}/0"), found));
        }
        _ => {}
    }
}

#[test]
fn unknown_and_missing_fields_break_the_schema_as_they_break_reading() {
    for (value, schema) in written() {
        let reads = |value: &Value| {
            let bytes = serde_json::to_vec(value).unwrap();
            match value["format"].as_str() {
                Some(Library::FORMAT) => Library::from_bytes(&bytes, "x").is_ok(),
                Some(TunedWeights::FORMAT) => TunedWeights::from_bytes(&bytes, "x").is_ok(),
                Some(Scene::FORMAT) => Scene::from_bytes(&bytes, "x").is_ok(),
                _ => MasksFile::from_bytes(bytes, "x").is_ok(),
            }
        };
        assert!(reads(&value));
        let mut places = Vec::new();
        objects(&value, "", &mut places);
        for place in places {
            let mut wrong = value.clone();
            wrong.pointer_mut(&place).unwrap()["unheard_of"] = json!(1);
            assert!(check(&wrong, &schema, &schema, "$").is_err(), "{place}");
            assert!(!reads(&wrong), "{place}");
        }
        // Fields that may be missing.
        let optional = ["parameters", "guide"];
        for field in value.as_object().unwrap().keys().filter(|key| !optional.contains(&key.as_str())) {
            let mut wrong = value.clone();
            wrong.as_object_mut().unwrap().remove(field);
            assert!(check(&wrong, &schema, &schema, "$").is_err(), "{field}");
            assert!(!reads(&wrong), "{field}");
        }
    }
}
