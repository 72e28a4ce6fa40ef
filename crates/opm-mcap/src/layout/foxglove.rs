//! The layout file of Foxglove and Lichtblick.

use super::extent::Extent;
use super::plots::{Plot, columns};
use super::{Layout, View};
use crate::trajectory::VIOLATIONS_TOPIC;
use serde_json::{Map, Value, json};

/// The distance of the camera from the middle, in radii of what is shown: all of it is in view.
const DISTANCE: f64 = 2.6;
/// The near plane and the far plane, in radii.
const NEAR: f64 = 1.0 / 200.0;
const FAR: f64 = 200.0;
/// The share of a column that the mechanism has above the log, percent.
const ABOVE_LOG: f64 = 85.0;
/// The share of a row that the mechanism has beside plots, percent.
const BESIDE_PLOTS: f64 = 55.0;

impl Layout {
    /// The text of a layout file (JSON) for Foxglove and Lichtblick. The camera sees everything, labels of frames are off,
    /// and the right topics are on. A workspace is an overview beside the slice, a motion is the mechanism and its log
    /// beside a plot for each role and unit.
    pub fn foxglove(&self) -> String {
        let mut panels = Map::new();
        let mut add = |kind: &str, number: usize, config: Value| {
            let id = format!("{kind}!opm{number}");
            panels.insert(id.clone(), config);
            Value::String(id)
        };
        let views: Vec<Value> = (self.views.iter().enumerate())
            .map(|(number, view)| add("3D", number, self.view(view)))
            .collect();
        let mut numbers = 0..;
        let columns = columns(&self.plots).filter_map(|plots| {
            let added = plots.iter().zip(&mut numbers);
            let panels = added.map(|(plot, number)| add("Plot", number, self::plot(plot)));
            even("column", &panels.collect::<Vec<_>>())
        });
        let columns: Vec<Value> = columns.collect();
        let log = self.violations.then(|| {
            let config = titled(
                json!({ "topicToRender": VIOLATIONS_TOPIC, "searchTerms": [], "minLogLevel": 1 }),
                "Violations",
            );
            add("RosOut", 0, config)
        });
        let views = even("row", &views);
        let left = match (views, log) {
            (Some(views), Some(log)) => Some(split("column", views, log, ABOVE_LOG)),
            (views, log) => views.or(log),
        };
        let layout = match (left, even("row", &columns)) {
            (Some(left), Some(right)) => split("row", left, right, BESIDE_PLOTS),
            (left, right) => left.or(right).unwrap_or_default(),
        };
        let file = json!({
            "configById": panels,
            "globalVariables": {},
            "userNodes": {},
            "playbackConfig": { "speed": 1 },
            "layout": layout,
        });
        format!("{file:#}\n")
    }

    fn view(&self, view: &View) -> Value {
        let View { title, frame, extent, shown, hidden, .. } = view;
        let (centre, radius) = (extent.centre(), extent.radius());
        let on = |(name, size): &(String, u32)| {
            let settings = match size {
                0 => json!({ "visible": true }),
                size => json!({
                    "visible": true,
                    "pointSize": size,
                    "pointShape": "circle",
                    "colorMode": "rgba-fields",
                }),
            };
            (name.clone(), settings)
        };
        let off = |name: &String| (name.clone(), json!({ "visible": false }));
        let topics: Map<String, Value> =
            shown.iter().map(on).chain(hidden.iter().map(off)).collect();
        let config = json!({
            "followTf": frame,
            "followMode": "follow-none",
            "cameraState": {
                "perspective": true,
                "distance": DISTANCE * radius,
                "phi": 60,
                "thetaOffset": 45,
                "target": centre,
                "targetOffset": centre,
                "targetOrientation": [0, 0, 0, 1],
                "fovy": 45,
                "near": NEAR * radius,
                "far": FAR * radius,
            },
            "scene": {
                "transforms": {
                    "showLabel": false,
                    "axisScale": 0,
                    "lineWidth": 0,
                    "enablePreloading": true,
                },
            },
            "topics": topics,
            "layers": { "grid": grid(extent) },
            "transforms": {},
        });
        titled(config, if self.views.len() == 1 { &self.title } else { title })
    }
}

/// A grid below what is shown, as large as that.
fn grid(extent: &Extent) -> Value {
    let [x, y, _] = extent.centre();
    json!({
        "visible": true,
        "frameLocked": true,
        "label": "Grid",
        "instanceId": "grid",
        "layerId": "foxglove.Grid",
        "size": round_up(2.0 * extent.radius()),
        "divisions": 10,
        "lineWidth": 1,
        "color": "#8888884d",
        "position": [x, y, extent.low[2]],
        "rotation": [0, 0, 0],
        "order": 1,
    })
}

/// The next of 1, 2 and 5 times a power of ten.
fn round_up(size: f64) -> f64 {
    let power = 10f64.powf(size.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps.into_iter().find(|step| *step >= size).unwrap_or(size)
}

fn plot(plot: &Plot) -> Value {
    let Plot { title, unit, topic, curves, .. } = plot;
    let path = |(field, name): &(String, String)| {
        json!({
            "value": format!("{topic}.{field}"),
            "label": name,
            "enabled": true,
            "timestampMethod": "receiveTime",
        })
    };
    let config = json!({
        "title": title,
        "paths": curves.iter().map(path).collect::<Vec<_>>(),
        "xAxisVal": "timestamp",
        "yAxisLabel": unit,
        "showXAxisLabels": true,
        "showYAxisLabels": true,
        "showLegend": true,
        "legendDisplay": "left",
        "showPlotValuesInLegend": false,
        "sidebarDimension": 110,
        "isSynced": true,
    });
    titled(config, title)
}

/// Gives a panel its title, for which the two viewers have different keys.
fn titled(mut config: Value, title: &str) -> Value {
    for key in ["foxglovePanelTitle", "lichtblickPanelTitle"] {
        config[key] = title.into();
    }
    config
}

fn split(direction: &str, first: Value, second: Value, percentage: f64) -> Value {
    let parts = [
        ("first", first),
        ("second", second),
        ("direction", direction.into()),
        ("splitPercentage", percentage.into()),
    ];
    parts.into_iter().map(|(key, part)| (key.to_owned(), part)).collect()
}

/// Panels of the same size; `None` without any.
fn even(direction: &str, panels: &[Value]) -> Option<Value> {
    let (first, rest) = panels.split_first()?;
    match even(direction, rest) {
        None => Some(first.clone()),
        Some(rest) => Some(split(direction, first.clone(), rest, 100.0 / panels.len() as f64)),
    }
}
