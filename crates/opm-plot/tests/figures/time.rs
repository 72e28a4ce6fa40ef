//! Curves over time.

use crate::picture::decoded;
use crate::seen::{ROUNDING, across, assert_legible, class, label, named, paths, pieces, text, up};
use opm_plot::{
    Curve, Heading, Measure, Panel, PanelRow, Scale, Size, Steps, TimeFigure, Unit, png,
};
use roxmltree::Document;

const SAMPLES: u32 = 201;

fn time(i: u32) -> f64 {
    f64::from(i) * 0.05
}

/// Value of curve `k` at sample `i`.
fn value(k: usize, i: u32) -> f64 {
    (k as f64 + 1.0) * 40.0 * (time(i) * (0.6 + 0.3 * k as f64)).sin() + 10.0
}

fn curve(value: impl Fn(u32) -> f64) -> Curve {
    let mut curve = Curve::default();
    (0..SAMPLES).for_each(|i| curve.push(time(i), value(i)));
    curve
}

fn unit(symbol: &str) -> Unit {
    let steps = if symbol == "deg" { Steps::Degrees } else { Steps::Decimal };
    Unit { symbol: symbol.into(), steps, resolution: 1e-6 }
}

fn panel(symbol: &str, curves: Vec<(usize, Curve)>) -> Panel {
    let (title, name) = (format!("Panel in {symbol}"), "value".to_owned());
    Panel { title, name, unit: unit(symbol), scale: Scale::Linear, curves, limits: vec![] }
}

fn row(names: &[&str], panels: Vec<Option<Panel>>) -> PanelRow {
    PanelRow { names: names.iter().map(ToString::to_string).collect(), panels }
}

fn figure(rows: Vec<PanelRow>) -> TimeFigure {
    let heading = Heading {
        title: "A figure".into(),
        lines: vec!["of curves".into()],
        notes: vec!["made up".into()],
    };
    TimeFigure {
        heading,
        over: Measure::time(),
        range: [0.0, 10.0],
        rows,
        invalid: vec![],
        marks: vec![],
    }
}

fn two_rows() -> TimeFigure {
    let curves = |n: usize| (0..n).map(|k| (k, curve(|i| value(k, i)))).collect();
    figure(vec![
        row(&["x", "y"], vec![Some(panel("mm", curves(2))), Some(panel("mm/s", curves(2)))]),
        row(&["phi"], vec![Some(panel("deg", curves(1))), None]),
    ])
}

/// Each vertex of a curve, read by the numbers at the axes, is a sample.
#[test]
fn curves_are_where_the_axes_say() {
    let svg = text(&two_rows().draw(None).unwrap());
    let document = Document::parse(&svg).unwrap();
    let panels = class(document.root(), "panel");
    let titles: Vec<&str> = panels.iter().map(|p| label(*p)).collect();
    assert_eq!(titles, ["Panel in mm", "Panel in mm/s", "Panel in deg"]);
    for (number, names) in [(0, &["x", "y"][..]), (1, &["x", "y"]), (2, &["phi"])] {
        let panel = panels[number];
        let (up, found) = (up(panel), class(panel, "curve"));
        assert_eq!(found.iter().map(|c| label(*c)).collect::<Vec<_>>(), names);
        // The first panel has no numbers below: the last one of its column has them.
        let below = if number == 0 { panels[2] } else { panel };
        let across = across(below);
        for (k, curve) in found.into_iter().enumerate() {
            let pieces = pieces(paths(curve)[0]);
            let [piece] = &pieces[..] else { panic!("{} pieces", pieces.len()) };
            assert_eq!(piece.len() as u32, SAMPLES);
            for (i, [x, y]) in (0..).zip(piece) {
                let (t, v) = (across(*x), up(*y));
                let per_pixel = (across(1.0) - across(0.0)).abs();
                assert!((t - time(i)).abs() < 2.0 * ROUNDING * per_pixel, "{t} {}", time(i));
                let per_pixel = (up(1.0) - up(0.0)).abs();
                assert!((v - value(k, i)).abs() < 2.0 * ROUNDING * per_pixel, "{v} {i}");
            }
        }
    }
    let names: Vec<&str> = class(document.root(), "y-axis").iter().map(|a| label(*a)).collect();
    assert_eq!(names, ["value (mm)", "value (mm/s)", "value (deg)"]);
    let below: Vec<&str> = class(document.root(), "x-axis").iter().map(|a| label(*a)).collect();
    assert_eq!(below, ["time (s)", "time (s)"], "once a column");
    let legend = class(document.root(), "legend");
    let names = legend.iter().flat_map(|l| class(*l, "text"));
    assert_eq!(names.map(label).collect::<Vec<_>>(), ["x", "y", "phi"]);
}

#[test]
fn texts_keep_apart_whatever_they_say() {
    let huge = |k: f64| curve(|i| k * value(0, i));
    let long = "a.joint.whose.name.goes.on.and.on.until.nobody.reads.it.any.more";
    let many: Vec<String> = (0..30).map(|i| format!("joint{i}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    let all = (0..30).map(|k| (k, curve(|i| value(k, i)))).collect();
    let mut marked = two_rows();
    marked.marks = (0..60).map(|i| f64::from(i * i) * 0.002).collect();
    marked.invalid = vec![[1.0, 2.5], [3.0, 3.0]];
    marked.heading.notes = vec!["a note that needs more than a line ".repeat(12)];
    let mut log = panel("", vec![(0, curve(|i| f64::from(i).exp2()))]);
    log.scale = Scale::Logarithmic;
    for figure in [
        two_rows(),
        marked,
        figure(vec![row(&[long], vec![Some(panel("mm", vec![(0, huge(1e12))]))])]),
        figure(vec![row(&["a"], vec![Some(panel("deg", vec![(0, huge(1e-17))]))])]),
        figure(vec![row(&["a"], vec![Some(panel("deg", vec![(0, curve(|_| 123.456_789))]))])]),
        figure(vec![row(&["a"], vec![Some(panel("m", vec![(0, huge(1e-300))]))])]),
        figure(vec![row(&["a"], vec![Some(panel("m", vec![(0, curve(|_| f64::NAN))]))])]),
        figure(vec![row(&many, vec![Some(panel("mm", all))])]),
        figure(vec![row(&["c"], vec![Some(log)])]),
    ] {
        let drawing = figure.draw(None).unwrap();
        assert_legible(&text(&drawing));
        let Size { width, height } = drawing.size;
        let larger = Size { width: width + 300.0, height: height + 300.0 };
        assert_legible(&text(&figure.draw(Some(larger)).unwrap()));
    }
}

#[test]
fn a_size_that_is_too_small_names_one_that_is_not() {
    let figure = two_rows();
    let error = figure.draw(Some(Size { width: 300.0, height: 200.0 })).unwrap_err();
    assert_eq!(error.panels, 3);
    let drawing = figure.draw(Some(error.needed)).unwrap();
    assert_eq!(drawing.size, error.needed);
    assert_legible(&text(&drawing));
    let Size { width, height } = error.needed;
    for size in [Size { width: width - 2.0, height }, Size { width, height: height - 2.0 }] {
        assert!(figure.draw(Some(size)).is_err());
    }
}

#[test]
fn gaps_part_a_curve_and_single_samples_are_seen() {
    let gap = |i: u32| (50..60).contains(&i) || i == 70 || i == 72;
    let curve = curve(|i| if gap(i) { f64::NAN } else { value(0, i) });
    let svg = text(
        &figure(vec![row(&["a"], vec![Some(panel("mm", vec![(0, curve)]))])]).draw(None).unwrap(),
    );
    let document = Document::parse(&svg).unwrap();
    let found = paths(named(document.root(), "curve", "a"));
    let lengths: Vec<usize> = pieces(found[0]).iter().map(Vec::len).collect();
    assert_eq!(lengths, [50, 10, 128]);
    assert_eq!(pieces(found[1]).len(), 1, "sample 71 is a dot");
}

/// Limits that are near are dashed lines at their values; one that is far away would leave no room for the curves.
#[test]
fn limits_are_dashed_where_they_are_near() {
    let mut limited = panel("mm", vec![(0, curve(|i| value(0, i))), (1, curve(|i| value(0, i)))]);
    limited.limits = vec![(0, 60.0), (1, 75.0), (0, -45.0), (1, -45.0), (0, 4000.0)];
    let svg = text(&figure(vec![row(&["x", "y"], vec![Some(limited)])]).draw(None).unwrap());
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panel = named(document.root(), "panel", "Panel in mm");
    let (up, lines) = (up(panel), class(panel, "limits"));
    let lines = paths(lines[0]);
    let found: Vec<f64> = lines.iter().map(|line| up(pieces(*line)[0][0][1])).collect();
    for (found, expected) in found.iter().zip([60.0, 75.0, -45.0]) {
        assert!((found - expected).abs() < 0.5, "{found} {expected}");
    }
    assert_eq!(found.len(), 3);
    let colors: Vec<_> = lines.iter().map(|line| line.attribute("stroke")).collect();
    assert!(colors[0] != colors[1] && colors[2] != colors[0] && colors[2] != colors[1]);
    assert!(lines.iter().all(|line| line.attribute("stroke-dasharray").is_some()));
}

#[test]
fn spans_and_marks_are_at_their_times() {
    let mut figure = two_rows();
    (figure.invalid, figure.marks) = (vec![[2.0, 4.5]], vec![2.0, 7.25]);
    let svg = text(&figure.draw(None).unwrap());
    let document = Document::parse(&svg).unwrap();
    let panels = class(document.root(), "panel");
    for panel in &panels {
        let below = if label(*panel) == "Panel in mm" { panels[2] } else { *panel };
        let across = across(below);
        let shade = pieces(paths(*panel)[0]);
        let [left, right] = [shade[0][0][0], shade[0][1][0]].map(&across);
        assert!((left - 2.0).abs() < 1e-3 && (right - 4.5).abs() < 1e-3, "{left} {right}");
        let marks = class(*panel, "marks")[0];
        let at: Vec<f64> =
            paths(marks).into_iter().map(|line| across(pieces(line)[0][0][0])).collect();
        assert!((at[0] - 2.0).abs() < 1e-3 && (at[1] - 7.25).abs() < 1e-3, "{at:?}");
    }
    let numbers: Vec<_> = class(class(panels[0], "marks")[0], "text");
    assert_eq!(numbers.into_iter().map(label).collect::<Vec<_>>(), ["1", "2"]);
}

#[test]
fn a_png_shows_it_in_the_stated_size() {
    let drawing = two_rows().draw(Some(Size { width: 900.0, height: 500.0 })).unwrap();
    let bytes = png::write(&drawing).unwrap();
    let picture = decoded(&bytes);
    assert_eq!(picture.size, [1800, 1000]);
    let color = |rgb: [u8; 3]| picture.pixels.iter().filter(|pixel| **pixel == rgb).count();
    for k in 0..2 {
        assert!(color(opm_plot::color::line(k).0) > 500, "curve {k}");
    }
    assert!(color(opm_plot::color::INK) > 1000, "text and axes");
    assert!(color(opm_plot::color::WHITE) > 1_000_000);
    assert_eq!(color([0; 3]), 0);
}

#[test]
fn the_same_figure_gives_the_same_bytes() {
    let drawing = || two_rows().draw(None).unwrap();
    assert_eq!(text(&drawing()), text(&drawing()));
    assert_eq!(png::write(&drawing()).unwrap(), png::write(&drawing()).unwrap());
}

#[test]
fn a_million_samples_make_a_small_file() {
    let mut curve = Curve::default();
    for i in 0..1_000_000 {
        curve.push(f64::from(i) * 1e-5, (f64::from(i) * 0.01).sin());
    }
    let svg = text(
        &figure(vec![row(&["a"], vec![Some(panel("mm", vec![(0, curve)]))])]).draw(None).unwrap(),
    );
    assert!(svg.len() < 1_000_000, "{} bytes", svg.len());
}
