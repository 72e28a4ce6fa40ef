//! The part of the schema that describes the parameters of families.

use super::Properties;
use super::values::{
    array, described, drive_limit, exactly, form, joined_tables, limits, name, number, object,
    point, text,
};
use crate::mechanism::family::{
    FORMS, Family, FamilyForm, Group, JointTable, Parameter, ParameterRef, TableKey,
};
use crate::mechanism::file::joints::FAMILY_TASK_KEYS;
use crate::mechanism::file::parameters::{joint_keys, keys};
use crate::mechanism::file::read::FAMILY_KEYS;
use crate::mechanism::joint::{DriveLimit, DriveNumber, MotionLimit};
use crate::numeric::Quantity;
use serde_json::{Value, json};

/// The keys of each family, with its name.
pub fn forms() -> Vec<(&'static str, Value)> {
    FORMS.iter().map(|(word, form)| (*word, form_of(form))).collect()
}

/// What the keys of families mean, apart from legs that are called `leg`.
pub fn properties() -> Properties {
    let mut properties = Properties::new();
    let words = FORMS.map(|(word, _)| word);
    let description = "The family, if the mechanism is given by the parameters of one. Without it, the \
                       file lists joints.";
    properties.insert("family".to_owned(), json!({ "description": description, "enum": words }));
    let mode = "The working mode of home: one sign for each choice, in a group for each leg, such as \
                \"++ ++ ++ +\". If it is not given, every sign is +.";
    properties.insert("mode".to_owned(), text(mode));
    let families = all_tables();
    let each: Vec<_> = families.iter().map(|(word, tables)| (*word, tables)).collect();
    properties.extend(joined_tables(&each));
    properties.remove("leg");
    properties
}

/// What the keys of the legs in the array `key` mean.
pub fn legs_called(key: &str) -> Properties {
    let families = all_tables();
    let mut each = Vec::new();
    for (word, tables) in &families {
        let legs = tables.get(key).and_then(|legs| legs["items"]["properties"].as_object());
        each.extend(legs.map(|legs| (*word, legs)));
    }
    joined_tables(&each)
}

/// The tables of each family, with its name.
fn all_tables() -> Vec<(&'static str, Properties)> {
    FORMS.iter().map(|(word, form)| (*word, tables(&mut (form.blank)()))).collect()
}

/// What the tables of a family mean: `home`, and those of its legs.
fn tables(family: &mut Family) -> Properties {
    let mut tables = Properties::new();
    for group in family.groups() {
        let (key, table) = match group.table {
            TableKey::Home => ("home", described(HOME, object(meanings(&group)))),
            TableKey::Leg(key) => {
                (key, described("The parameters of this leg.", object(leg(&group))))
            }
            TableKey::Legs(key) => {
                (key, array("The parameters of these legs.", object(leg(&group))))
            }
        };
        tables.insert(key.to_owned(), table);
    }
    tables
}

const HOME: &str =
    "The pose at which the mechanism is assembled. A coordinate that is not given is 0.";

/// What the keys of a leg mean.
fn leg(group: &Group<'_>) -> Properties {
    let mut properties = Properties::new();
    let description = "The leg's name. If it is not given: leg1, leg2, ...";
    properties.insert("name".to_owned(), name(description));
    properties.extend(meanings(group));
    for table in JointTable::ALL {
        let joints = group.parameters.iter().filter(|parameter| parameter.table == Some(table));
        let joints =
            joints.filter_map(|parameter| Some((parameter.key.to_owned(), joint(parameter)?)));
        let table_of = described(joint_table(table), object(joints.collect()));
        properties.insert(table.key().to_owned(), table_of);
    }
    properties
}

/// What a table with a value for each joint of a leg means.
fn joint_table(table: JointTable) -> &'static str {
    match table {
        JointTable::Limits => {
            "Limits of the leg's joints, [lowest, highest]. A joint without limits is free."
        }
        JointTable::Drive(DriveLimit::Motion(MotionLimit::Rate)) => {
            "The largest rates of the leg's joints, with which trajectories are compared."
        }
        JointTable::Drive(DriveLimit::Motion(MotionLimit::Acceleration)) => {
            "The largest accelerations of the leg's joints, with which trajectories are compared."
        }
        JointTable::Drive(DriveLimit::Effort) => {
            "The largest efforts of the leg's actuators, from which the capacity of a pose follows."
        }
        JointTable::Number(DriveNumber::RotorInertia) => {
            "The inertias of the rotors of the leg's actuators, kg m^2."
        }
        JointTable::Number(DriveNumber::Gear) => {
            "How much faster than the leg's joints the rotors turn, 1 if it is not given."
        }
        JointTable::Number(DriveNumber::ViscousFriction) => {
            "The friction of the leg's joints for a rate of one."
        }
        JointTable::Number(DriveNumber::CoulombFriction) => {
            "The friction of the leg's joints against their rates."
        }
        JointTable::Offset => {
            "The values of the leg's joints where the family's formulas have their zeros: the offsets of encoders."
        }
    }
}

/// The unit of a number of a drive, as a sentence.
fn drive_unit(number: DriveNumber, quantity: Quantity) -> &'static str {
    match (number, quantity) {
        (DriveNumber::RotorInertia, _) => " In kg m^2.",
        (DriveNumber::Gear, Quantity::Angle) => "",
        (DriveNumber::Gear, Quantity::Length) => " In radians per units.length.",
        (DriveNumber::ViscousFriction, Quantity::Angle) => " In N m s/rad.",
        (DriveNumber::ViscousFriction, Quantity::Length) => " In N s/m.",
        (DriveNumber::CoulombFriction, Quantity::Angle) => " In N m.",
        (DriveNumber::CoulombFriction, Quantity::Length) => " In N.",
    }
}

/// What a joint's value in such a table means.
fn joint(Parameter { key, target, .. }: &Parameter<'_>) -> Option<Value> {
    match target {
        ParameterRef::Limits(quantity, _) => {
            let what = format!("The lowest and the highest value of the joint {key}.");
            Some(limits(&what, *quantity))
        }
        ParameterRef::DriveLimit(limit, quantity, _) => {
            Some(drive_limit(&format!("Of the joint {key}."), *limit, *quantity))
        }
        ParameterRef::Drive(of, quantity, _) => {
            let unit = drive_unit(*of, *quantity);
            let description = format!("Of the joint {key}.{unit} At least 0.");
            Some(json!({ "description": description, "type": ["number", "string"], "minimum": 0 }))
        }
        ParameterRef::Offset(quantity, _) => {
            Some(number(&format!("Of the joint {key}."), *quantity))
        }
        ParameterRef::Number(..) | ParameterRef::Optional(..) | ParameterRef::Point(_) => None,
    }
}

/// What the parameters of a group mean, apart from limits.
fn meanings(group: &Group<'_>) -> Properties {
    let meaning = |Parameter { key, expected, target, .. }: &Parameter<'_>| {
        let value = match target {
            ParameterRef::Number(quantity, _) => number(expected, *quantity),
            ParameterRef::Optional(quantity, _) => {
                number(&format!("{expected}; only for legs that have one"), *quantity)
            }
            ParameterRef::Point(_) => point(expected, 2),
            ParameterRef::Limits(..)
            | ParameterRef::DriveLimit(..)
            | ParameterRef::Drive(..)
            | ParameterRef::Offset(..) => {
                return None;
            }
        };
        Some(((*key).to_owned(), value))
    };
    group.parameters.iter().filter_map(meaning).collect()
}

/// The keys of one family.
fn form_of(family: &FamilyForm) -> Value {
    let mut narrower = vec![("mode", json!({ "pattern": mode_pattern(family.choices) }))];
    let mut blank = (family.blank)();
    let groups = blank.groups();
    for group in &groups {
        let parameters = &group.parameters;
        let keys = keys(parameters);
        let required: Vec<_> =
            parameters.iter().filter(|p| is_required(p)).map(|p| p.key).collect();
        let tables = JointTable::ALL
            .map(|table| (table.key(), form(&joint_keys(parameters, table), &[], &[])));
        let leg = || form(&keys, &required, &tables);
        match group.table {
            TableKey::Home => {
                let coordinates: Vec<_> = parameters.iter().map(|p| p.key).collect();
                narrower.push(("home", form(&coordinates, &[], &[])));
            }
            TableKey::Leg(key) => narrower.push((key, leg())),
            TableKey::Legs(key) => {
                let alike = groups.iter().filter(|other| other.table == group.table).count();
                narrower.push((key, exactly(alike, json!({ "items": leg() }))));
            }
        }
    }
    let mut legs: Vec<_> = groups
        .iter()
        .filter_map(|group| match group.table {
            TableKey::Home => None,
            TableKey::Leg(key) | TableKey::Legs(key) => Some(key),
        })
        .collect();
    legs.dedup();
    let task = form(FAMILY_TASK_KEYS, &[], &[]);
    narrower.push(("task", task));
    form(&[family.keys, FAMILY_KEYS].concat(), &legs, &narrower)
}

/// Whether a leg must have the parameter.
fn is_required(parameter: &Parameter<'_>) -> bool {
    match parameter.target {
        ParameterRef::Number(..) | ParameterRef::Point(_) => true,
        ParameterRef::Optional(..)
        | ParameterRef::Limits(..)
        | ParameterRef::DriveLimit(..)
        | ParameterRef::Drive(..)
        | ParameterRef::Offset(..) => false,
    }
}

/// The pattern of working modes: as many signs as a leg has choices, in a group for each leg.
fn mode_pattern(choices: &[usize]) -> String {
    let groups: Vec<_> = choices.iter().map(|count| format!("[+-]{{{count}}}")).collect();
    format!(r"^\s*{}\s*$", groups.join(r"\s+"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_is_that_of_its_family() {
        for (word, form) in FORMS {
            let mut blank = (form.blank)();
            assert_eq!(blank.word(), word);
            for group in blank.groups() {
                let key = match group.table {
                    TableKey::Home => "home",
                    TableKey::Leg(key) | TableKey::Legs(key) => key,
                };
                assert!(form.keys.contains(&key), "{word}: {key}");
            }
        }
    }

    #[test]
    fn modes_have_a_group_for_each_leg() {
        assert_eq!(mode_pattern(&[2, 1]), r"^\s*[+-]{2}\s+[+-]{1}\s*$");
        assert_eq!(mode_pattern(&[]), r"^\s*\s*$");
    }
}
