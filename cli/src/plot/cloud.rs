//! The values that joints take in a workspace, plotted against each other.

use super::source::{Rate, Source};
use crate::text::count;
use opm_mcap::Cloud as Points;
use opm_plot::color::Map;
use opm_plot::{Bar, Cloud, Content, Histogram, Measure, Scale, Section, Tile};
use opm_study::WorkspaceKind;

/// Largest number of joints that are plotted against each other: six pairs.
const MOST: usize = 4;

/// Joint values that are being collected.
pub struct JointCloud {
    /// The kind of the workspace.
    kind: WorkspaceKind,
    joints: Vec<Joint>,
    /// Whether all of them are values of joints.
    only_joints: bool,
    /// Values that are left out for lack of space.
    left_out: usize,
    /// A single joint, or every pair.
    content: Vec<(usize, usize, Content)>,
    points: u64,
}

struct Joint {
    field: String,
    measure: Measure,
    factor: f64,
}

impl JointCloud {
    /// `None` if no joints are stored.
    pub fn new(kind: WorkspaceKind, source: &Source<'_>, names: &[String]) -> Option<Self> {
        let mut joints = vec![];
        let mut ranges = vec![];
        for name in names.iter().take(MOST) {
            let (measure, factor) =
                source.measure(name, source.joint_quantity(name), Rate::Position);
            let extent = source.recording.extents.iter().find(|extent| extent.field == *name)?;
            ranges.push([extent.min / factor, extent.max / factor]);
            joints.push(Joint { field: name.clone(), measure, factor });
        }
        let content = match ranges[..] {
            [] => return None,
            [range] => vec![(0, 0, Content::Histogram(Histogram::new(range)))],
            _ => (0..ranges.len())
                .flat_map(|a| (a + 1..ranges.len()).map(move |b| (a, b)))
                .map(|(a, b)| (a, b, Content::Cloud(Cloud::new(ranges[a], ranges[b]))))
                .collect(),
        };
        let only_joints = joints.iter().all(|joint| source.joint_quantity(&joint.field).is_some());
        let left_out = names.len() - joints.len();
        Some(Self { kind, only_joints, left_out, joints, content, points: 0 })
    }

    /// Adds the points of a message.
    pub fn add(&mut self, cloud: &Points<'_>) {
        let column = |joint: &Joint| -> Vec<f64> {
            let column = cloud.column(&joint.field).into_iter().flatten();
            column.map(|value| value / joint.factor).collect()
        };
        let columns: Vec<Vec<f64>> = self.joints.iter().map(column).collect();
        for (a, b, content) in &mut self.content {
            let (x, y) = (&columns[*a], &columns[*b]);
            match content {
                Content::Cloud(cloud) => x.iter().zip(y).for_each(|(x, y)| cloud.push(*x, *y)),
                Content::Histogram(histogram) => x.iter().for_each(|x| histogram.push(*x)),
                Content::Cells(..) | Content::Polar(..) => {}
            }
        }
        self.points += cloud.len() as u64;
    }

    /// Notes on the picture.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = vec![];
        let dots = |content: &Content| matches!(content, Content::Cloud(cloud) if cloud.has_dots());
        if self.content.iter().any(|(_, _, content)| dots(content)) {
            notes.push(format!(
                "{}: a dot for all of the {} {} that it covers.",
                self.values(),
                count(self.points),
                self.kind.point_name()
            ));
        }
        if self.left_out > 0 {
            let (drawn, all) = (self.joints.len(), self.joints.len() + self.left_out);
            notes.push(format!("{drawn} of {all} values are drawn; --values chooses others."));
        }
        notes
    }

    /// The heading of the values.
    fn values(&self) -> &'static str {
        if self.only_joints { "Joint values" } else { "Values" }
    }

    /// The finished tiles.
    pub fn section(self) -> Section {
        let points = self.kind.point_name();
        let measure = |number: usize| self.joints[number].measure.clone();
        let names: Vec<&str> = self.joints.iter().map(|joint| &*joint.field).collect();
        let (values, reached, names) = (self.values(), self.kind.member_name(), names.join(", "));
        let title = format!("{values} in {reached} {points}: {names}");
        let tile = |(a, b, content): (usize, usize, Content)| {
            let y = match content {
                Content::Histogram(_) => Measure::count(points),
                _ => measure(b),
            };
            Tile { title: String::new(), x: measure(a), y, content, mark: None }
        };
        let columns = match self.content.len() {
            4 => 2,
            tiles => tiles.min(3),
        };
        let tiles = self.content.into_iter().map(tile).collect();
        let mut section =
            Section { title, columns, shared: false, tiles, bar: None, legend: vec![] };
        let densest = section.densest();
        section.bar = (densest > 1).then(|| Bar {
            measure: Measure::count(&format!("{points} in one place")),
            range: [1.0, densest as f64],
            map: Map::Cividis,
            scale: Scale::Logarithmic,
        });
        section
    }
}
