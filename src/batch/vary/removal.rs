//! Takes an object out of a scene's text: the part, and all that names it.

use toml::{Table, Value};

/// Keys at the top of a scene whose text is for people.
const WORDS: [&str; 3] = ["format", "name", "description"];

/// Takes an object out of a scene. Goals that were about nothing else go, too.
pub(crate) fn remove(scene: &mut Table, object: &str) {
    drop_numbers(scene, object);
    let before = constraint_names(scene);
    let is_named = |name: &str| is_of(name, object);
    prune_scene(scene, &is_named);
    let after = constraint_names(scene);
    let gone: Vec<String> = before.into_iter().filter(|name| !after.contains(name)).collect();
    if !gone.is_empty() {
        prune_scene(scene, &|name: &str| gone.iter().any(|gone| gone == name));
    }
}

/// Whether a name is an object's, or of something of it.
fn is_of(name: &str, object: &str) -> bool {
    name.strip_prefix(object).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

fn constraint_names(scene: &Table) -> Vec<String> {
    let listed = scene.get("constraint").and_then(Value::as_array).into_iter().flatten();
    listed.filter_map(|constraint| Some(constraint.get("name")?.as_str()?.to_owned())).collect()
}

/// Takes an object's numbers out of configurations that are lists.
fn drop_numbers(scene: &mut Table, object: &str) {
    let Some(Value::Array(names)) = scene.get("coordinates") else { return };
    let stays: Vec<bool> = names.iter().map(|name| !name.as_str().is_some_and(|name| is_of(name, object))).collect();
    let thin = |value: Option<&mut Value>| {
        let Some(Value::Array(numbers)) = value else { return };
        let mut stays = stays.iter();
        numbers.retain(|_| stays.next().copied().unwrap_or(true));
    };
    thin(scene.get_mut("start"));
    for goal in scene.get_mut("goal").and_then(Value::as_array_mut).into_iter().flatten() {
        thin(goal.get_mut("configuration"));
    }
}

fn prune_scene(scene: &mut Table, is_named: &dyn Fn(&str) -> bool) {
    let keys: Vec<String> = scene.keys().filter(|key| !WORDS.contains(&key.as_str())).cloned().collect();
    for key in keys {
        let Some(value) = scene.get_mut(&key) else { continue };
        if key == "part" {
            prune_parts(value, is_named);
        } else if !prune(&key, value, false, is_named) {
            scene.remove(&key);
        }
    }
}

/// Names within a part are its own, but for those of its neighbours.
fn prune_parts(parts: &mut Value, is_named: &dyn Fn(&str) -> bool) {
    let Value::Array(parts) = parts else { return };
    parts.retain_mut(|part| {
        if let Some(neighbours) = part.get_mut("avoided_by") {
            prune("avoided_by", neighbours, false, is_named);
        }
        !part.get("name").and_then(Value::as_str).is_some_and(is_named)
    });
}

/// Takes out what is named; `false` where the whole value is about it. What stands in a list (a goal, a constraint, a rule) is about it
/// where one of its values is; elsewhere only that value goes.
fn prune(key: &str, value: &mut Value, in_list: bool, is_named: &dyn Fn(&str) -> bool) -> bool {
    match value {
        Value::String(name) => !is_named(name),
        Value::Array(items) => {
            let before = items.len();
            // A pair of links is none without one of them.
            let key = if key == "ignore" { "pair" } else { key };
            items.retain_mut(|item| {
                let had = has_content(item);
                prune(key, item, true, is_named) && (has_content(item) || !had)
            });
            let is_pair = key == "pair" && items.iter().any(Value::is_str);
            items.len() == before || !(is_pair || items.is_empty() && key != "grasps" && in_list)
        }
        Value::Table(table) => {
            table.retain(|name, _| !is_named(name));
            let keys: Vec<String> = table.keys().cloned().collect();
            for key in keys {
                let Some(value) = table.get_mut(&key) else { continue };
                let had = has_content(value);
                if prune(&key, value, in_list, is_named) {
                    if had && !has_content(value) && value.is_table() {
                        table.remove(&key);
                    }
                } else if in_list {
                    return false;
                } else {
                    table.remove(&key);
                }
            }
            true
        }
        _ => true,
    }
}

/// Whether a list or a table has anything in it; all else has.
fn has_content(value: &Value) -> bool {
    match value {
        Value::Array(items) => !items.is_empty(),
        Value::Table(table) => !table.is_empty(),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::remove;
    use toml::Table;

    fn without(object: &str, text: &str) -> Table {
        let mut scene: Table = text.parse().unwrap();
        remove(&mut scene, object);
        scene
    }

    // Long: a scene, and what is left of it.
    #[test]
    fn all_that_names_an_object_goes() {
        let text = r#"
            name = "can"
            coordinates = ["arm/a", "can/x", "cup/x", "can/y"]
            start = [1, 2, 3, 4]
            ignore = [["can", "cup"], ["cup", "table"]]
            margins = [{ pair = ["can/body", "table"], distance = 0.1 }, { pair = ["cup", "table"], distance = 0.1 }]
            [[part]]
            name = "can"
            [[part]]
            name = "cup"
            ignore = ["adjacent", ["can", "lid"]]
            avoided_by = ["can", "cup"]
            [graph]
            supports = ["table/top", "can/lid"]
            grasps = { "arm/hand" = ["can/top", "cup/top"] }
            everywhere = ["low", "high"]
            rules = [{ when = { "arm/hand" = "can/top" }, allow = false }, { when = { "arm/hand" = "empty" }, allow = true }]
            [graph.objects]
            can = { handles = ["top"] }
            cup = { handles = ["top"] }
            [[constraint]]
            name = "low"
            frame = { link = "can/body" }
            [[constraint]]
            name = "high"
            frame = "cup/body"
            [[goal]]
            configuration = [5, 6, 7, 8]
            [[goal]]
            objects = { can = [1], cup = [2] }
            [[goal]]
            objects = { can = [1] }
            [[goal]]
            hands = { "arm/hand" = "can/top" }
            on = { cup = "table/top" }
        "#;
        let expected = r#"
            name = "can"
            coordinates = ["arm/a", "cup/x"]
            start = [1, 3]
            ignore = [["cup", "table"]]
            margins = [{ pair = ["cup", "table"], distance = 0.1 }]
            [[part]]
            name = "cup"
            ignore = ["adjacent", ["can", "lid"]]
            avoided_by = ["cup"]
            [graph]
            supports = ["table/top"]
            grasps = { "arm/hand" = ["cup/top"] }
            everywhere = ["high"]
            rules = [{ when = { "arm/hand" = "empty" }, allow = true }]
            [graph.objects]
            cup = { handles = ["top"] }
            [[constraint]]
            name = "high"
            frame = "cup/body"
            [[goal]]
            configuration = [5, 7]
            [[goal]]
            objects = { cup = [2] }
        "#;
        assert_eq!(without("can", text), expected.parse::<Table>().unwrap());
    }

    #[test]
    fn names_that_only_begin_alike_stay() {
        let text = "[start]\nbox1 = 1\nbox10 = 2\n\"box1/x\" = 3";
        assert_eq!(without("box1", text), "[start]\nbox10 = 2".parse::<Table>().unwrap());
    }
}
