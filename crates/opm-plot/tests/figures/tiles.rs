//! Points in a plane.

use crate::picture::decoded;
use crate::seen::{ROUNDING, across, assert_legible, class, label, named, paths, pieces, text, up};
use opm_plot::color::Map;
use opm_plot::{
    Bar, Cells, Cloud, Content, Heading, Histogram, MOST_SHAPES, Measure, Paint, Scale, Section,
    Size, Spacing, Steps, Tile, TileFigure, Unit, png,
};
use roxmltree::Document;

fn measure(name: &str, symbol: &str) -> Measure {
    let steps = if symbol == "deg" { Steps::Degrees } else { Steps::Decimal };
    let unit = Unit { symbol: symbol.into(), steps, resolution: 1e-6 };
    Measure { name: name.into(), unit }
}

fn tile(title: &str, content: Content) -> Tile {
    let (x, y) = (measure("x", "mm"), measure("y", "mm"));
    Tile { title: title.into(), x, y, content, mark: None }
}

fn section(tiles: Vec<Tile>) -> Section {
    Section { title: "Section".into(), columns: 3, shared: true, tiles, bar: None, legend: vec![] }
}

fn figure(sections: Vec<Section>) -> TileFigure {
    let heading = Heading { title: "A figure".into(), lines: vec![], notes: vec!["Note".into()] };
    TileFigure { heading, sections }
}

const SIDE: usize = 41;
const GRID: Spacing = Spacing { first: -100.0, step: 5.0, count: SIDE };

/// A disc with a hole.
fn ring(radius: f64) -> (Cells, u64) {
    let mut cells = Cells::plain(GRID, GRID);
    let mut count = 0;
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        let (x, y) = (GRID.value(i), GRID.value(j));
        if (0.4 * radius..=radius).contains(&x.hypot(y)) {
            cells.push(x, y, 0.0);
            count += 1;
        }
    }
    (cells, count)
}

fn plain(cells: Cells) -> Content {
    Content::Cells(cells, Paint::Plain([0, 0x72, 0xb2]))
}

/// The boxes of a region have the area of its cells, and lie where the axes say.
#[test]
fn cells_are_where_the_axes_say() {
    let radii = [40.0, 60.0, 80.0, 95.0];
    let tiles = radii.map(|radius| tile(&format!("r = {radius}"), plain(ring(radius).0)));
    let drawing = figure(vec![section(tiles.into())]).draw(None).unwrap();
    let svg = text(&drawing);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panels = class(document.root(), "panel");
    // Two by two: numbers at the left and below only.
    let (left, below) = (up(panels[0]), across(panels[2]));
    let shift = |panel: usize, axis: usize| {
        let frame = |number: usize| {
            let boxes = paths(panels[number]).into_iter().flat_map(pieces);
            let wide = boxes.filter(|b| b.len() == 4).max_by(|a, b| {
                let width = |b: &[[f64; 2]]| b[1][0] - b[0][0];
                width(a).total_cmp(&width(b))
            });
            wide.unwrap()[0][axis]
        };
        frame(panel) - frame(if axis == 0 { 2 } else { 0 })
    };
    for (number, radius) in radii.into_iter().enumerate() {
        let points = class(panels[number], "points")[0];
        let (dx, dy) = (shift(number, 0), shift(number, 1));
        let boxes = pieces(paths(points)[0]);
        let mut area = 0.0;
        for corners in &boxes {
            let [[x0, y0], [x1, y1]] = [corners[0], corners[2]];
            let (x0, x1) = (below(x0 - dx), below(x1 - dx));
            let (y0, y1) = (left(y0 - dy), left(y1 - dy));
            area += (x1 - x0) * (y0 - y1);
            // Cells are centred on the grid's values.
            let middle = 0.5 * (y0 + y1) / GRID.step;
            assert!((middle - middle.round()).abs() < 0.02, "{middle}");
        }
        let expected = ring(radius).1 as f64 * GRID.step.powi(2);
        assert!((area - expected).abs() < 0.005 * expected, "{radius}: {area} {expected}");
    }
}

/// The direction is the angle around the middle, and the tilt the distance from it, in pictures of one colour and of many. A
/// boundary along the first and last direction, which are the same, is none.
#[test]
fn directions_go_around_and_tilts_outwards() {
    let grid = || [Spacing::between([-180.0, 180.0], 73), Spacing::between([0.0, 60.0], 31)];
    let hit = |mut cells: Cells| {
        for (direction, tilt) in (70..=110).step_by(5).flat_map(|d| (20..=40).map(move |t| (d, t)))
        {
            cells.push(f64::from(direction), f64::from(tilt), 1.0);
        }
        // What the circles reach to.
        cells.push(-90.0, 60.0, 1.0);
        cells.surround(vec![vec![[-180.0, 10.0], [-180.0, 50.0], [180.0, 50.0], [180.0, 10.0]]]);
        cells
    };
    let drawn = |content: Content| {
        let tile = Tile { mark: Some([0.0, 0.0]), ..tile("tilts", content) };
        figure(vec![section(vec![tile])]).draw(None).unwrap()
    };
    let [x, y] = grid();
    let plain = drawn(Content::Polar(hit(Cells::plain(x, y)), Paint::Plain([0, 114, 178]), 360.0));
    let svg = text(&plain);
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let cross = pieces(paths(class(document.root(), "mark")[0])[0]);
    let middle = [0, 1].map(|i| 0.5 * (cross[0][0][i] + cross[0][1][i]));
    let all = pieces(paths(class(document.root(), "points")[0])[0]);
    let polar = |[x, y]: [f64; 2]| {
        let [right, up] = [x - middle[0], middle[1] - y];
        [up.atan2(right).to_degrees(), right.hypot(up)]
    };
    // The upper edge of the last cell is at a tilt of 61.
    let furthest = all.iter().flatten().map(|p| polar(*p)[1]).fold(0.0, f64::max);
    let scale = 61.0 / furthest;
    for [direction, radius] in all.iter().flatten().map(|p| polar(*p)).filter(|p| p[0] > 0.0) {
        assert!((67.3..=112.7).contains(&direction), "{direction}");
        assert!((18.8..=41.2).contains(&(scale * radius)), "{}", scale * radius);
    }
    // Once around at a tilt of 50, and once at 10, without a line between them.
    let line = pieces(paths(class(document.root(), "points")[0])[1]).concat();
    let tilts: Vec<f64> = line.iter().map(|p| scale * polar(*p)[1]).collect();
    assert!(tilts.iter().all(|t| (t - 50.0).abs() < 0.2 || (t - 10.0).abs() < 0.2), "{tilts:?}");
    assert!(tilts.len() > 200);

    // The same in a PNG of cells with values.
    let values = Paint::Values(Map::Viridis, [0.0, 1.0]);
    let values = drawn(Content::Polar(hit(Cells::with_values(x, y)), values, 360.0));
    let png = decoded(&values.to_png().unwrap());
    let at = |direction: f64, tilt: f64| {
        let (sin, cos) = direction.to_radians().sin_cos();
        let [x, y] = [middle[0] + tilt / scale * cos, middle[1] - tilt / scale * sin];
        let [column, row] = [x, y].map(|v| (2.0 * v).round() as usize);
        png.pixels[row * png.size[0] as usize + column]
    };
    let yellow = Map::Viridis.color(1.0);
    assert_eq!(at(97.0, 27.0), yellow);
    assert_eq!([at(55.0, 27.0), at(97.0, 45.0), at(-97.0, 27.0)], [[255; 3]; 3]);
}

#[test]
fn too_many_cells_become_an_image() {
    let wide = Spacing { first: 0.0, step: 1.0, count: 300 };
    let mut board = Cells::plain(wide, wide);
    for (i, j) in
        (0..300).flat_map(|i| (0..300).map(move |j| (i, j))).filter(|(i, j)| (i + j) % 2 == 0)
    {
        board.push(f64::from(i), f64::from(j), 0.0);
    }
    let svg = text(&figure(vec![section(vec![tile("", plain(board))])]).draw(None).unwrap());
    let document = Document::parse(&svg).unwrap();
    assert_eq!(document.descendants().filter(|n| n.has_tag_name("image")).count(), 1);
    assert!(document.descendants().count() < 400);
    assert!(svg.len() < 400_000, "{} bytes", svg.len());
    // A grid that is finer than a picture.
    let fine = Spacing { first: 0.0, step: 1e-3, count: 100_000 };
    let mut cells = Cells::plain(fine, wide);
    cells.push(50.0, 150.0, 0.0);
    assert!(cells.is_coarse());
    let [[left, right], [low, high]] = cells.extent().unwrap();
    assert!(left <= 50.0 && right >= 50.0 && right - left < 0.2 && [low, high] == [149.5, 150.5]);
}

#[test]
fn values_colour_the_cells_by_their_mean() {
    let mut cells = Cells::with_values(GRID, GRID);
    for (x, value) in [(0.0, 0.0), (0.0, 2.0), (50.0, 10.0)] {
        cells.push(x, 0.0, value);
    }
    let mut section =
        section(vec![tile("", Content::Cells(cells, Paint::Values(Map::Viridis, [0.0, 10.0])))]);
    section.bar = Some(Bar {
        measure: measure("value", "mm"),
        range: [0.0, 10.0],
        map: Map::Viridis,
        scale: Scale::Linear,
    });
    let drawing = figure(vec![section]).draw(None).unwrap();
    assert_legible(&text(&drawing));
    let picture = decoded(&png::write(&drawing).unwrap());
    let has = |rgb: [u8; 3]| picture.pixels.contains(&rgb);
    assert!(has(Map::Viridis.color(0.1)) && has(Map::Viridis.color(1.0)));
}

#[test]
fn few_points_are_dots_and_many_an_image() {
    let at = |i: u32| [f64::from(i % 97), f64::from(i % 89 * i % 89)];
    let cloud = |points: u32, scatter: f64| {
        let mut cloud = Cloud::new([0.0, 97.0], [0.0, 89.0]);
        for i in 0..points {
            let [x, y] = at(i);
            cloud.push(x + scatter * f64::from(i % 1009) / 1009.0, y);
        }
        cloud
    };
    let draw = |cloud: Cloud| {
        let mut section = section(vec![tile("t", Content::Cloud(cloud))]);
        section.shared = false;
        text(&figure(vec![section]).draw(None).unwrap())
    };
    let svg = draw(cloud(90, 0.0));
    let document = Document::parse(&svg).unwrap();
    let panel = class(document.root(), "panel")[0];
    let (across, up) = (across(panel), up(panel));
    let dots = pieces(paths(named(document.root(), "points", "t"))[0]);
    let middle = |dot: &Vec<[f64; 2]>, i: usize| dot.iter().map(|p| p[i]).sum::<f64>() / 8.0;
    let slack = 3.0 * ROUNDING * (across(1.0) - across(0.0)).abs();
    let seen: Vec<[f64; 2]> =
        dots.iter().map(|d| [across(middle(d, 0)), up(middle(d, 1))]).collect();
    assert_eq!(seen.len(), 90);
    for (i, [x, y]) in (0..).zip(seen) {
        let [wanted_x, wanted_y] = at(i);
        assert!((x - wanted_x).abs() < slack && (y - wanted_y).abs() < slack, "{i}: {x} {y}");
    }
    // A hundred times the same points are the same dots.
    assert!(cloud(97 * 89 * 100, 0.0).has_dots() || MOST_SHAPES < 97 * 89);
    let many = cloud(200_000, 1.0);
    assert!(!many.has_dots() && many.points() == 200_000);
    let svg = draw(many);
    assert!(svg.contains("<image ") && svg.len() < 500_000, "{} bytes", svg.len());
}

#[test]
fn bars_are_as_long_as_their_numbers() {
    let mut histogram = Histogram::new([-10.0, 10.0]);
    let counts = [(-10.0, 40), (0.0, 100), (5.0, 7), (10.0, 1)];
    for (value, count) in counts {
        (0..count).for_each(|_| histogram.push(value));
    }
    let tile = Tile { y: Measure::count("poses"), ..tile("h", Content::Histogram(histogram)) };
    let mut section = section(vec![tile]);
    (section.shared, section.columns) = (false, 1);
    let svg = text(&figure(vec![section]).draw(None).unwrap());
    assert_legible(&svg);
    let document = Document::parse(&svg).unwrap();
    let panel = class(document.root(), "panel")[0];
    let (across, up) = (across(panel), up(panel));
    let bars = pieces(paths(named(document.root(), "points", "h"))[0]);
    assert_eq!(bars.len(), counts.len());
    for (bar, (value, count)) in bars.iter().zip(counts) {
        let middle = across(0.5 * (bar[0][0] + bar[1][0]));
        assert!((middle - value).abs() < 0.02, "{middle} {value}");
        assert!((up(bar[0][1]) - f64::from(count)).abs() < 0.1 && up(bar[2][1]).abs() < 0.1);
    }
    let mut many = Histogram::new([0.0, 1.0]);
    (0..10_000).for_each(|i| many.push(f64::from(i) / 9_999.0));
    assert!(!many.is_by_value());
    assert_eq!(many.extent().unwrap()[0], [0.0, 1.0]);
}

#[test]
fn nothing_and_one_place_are_drawn_too() {
    let empty = || Content::Cells(Cells::plain(GRID, GRID), Paint::Plain([0; 3]));
    let mut one = Cells::plain(Spacing::between([5.0, 5.0], 1), Spacing::between([0.0; 2], 1));
    one.push(5.0, 0.0, 0.0);
    one.push(f64::NAN, 0.0, 0.0);
    let mut cloud = Cloud::new([3.0, 3.0], [4.0, 4.0]);
    cloud.push(3.0, 4.0);
    cloud.push(f64::NAN, 4.0);
    assert_eq!(cloud.points(), 1);
    let mut level = Histogram::new([2.0, 2.0]);
    level.push(2.0);
    for content in [empty(), plain(one), Content::Cloud(cloud), Content::Histogram(level)] {
        let drawing = figure(vec![section(vec![tile("t", content), tile("e", empty())])]);
        let svg = text(&drawing.draw(None).unwrap());
        assert_legible(&svg);
        let document = Document::parse(&svg).unwrap();
        let texts = class(document.root(), "text");
        assert!(texts.into_iter().map(label).any(|text| text == "no poses"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}

#[test]
fn tiles_shrink_to_a_size_or_say_that_they_cannot() {
    let tiles = || (0..9).map(|i| tile(&format!("r = {i}"), plain(ring(80.0).0))).collect();
    let figure = figure(vec![section(tiles())]);
    let natural = figure.draw(None).unwrap().size;
    let smaller = Size { width: natural.width, height: 0.7 * natural.height };
    let drawing = figure.draw(Some(smaller)).unwrap();
    assert_eq!(drawing.size, smaller);
    assert_legible(&text(&drawing));
    let error = figure.draw(Some(Size { width: 200.0, height: 100.0 })).unwrap_err();
    assert_eq!(error.panels, 9);
    let drawing = figure.draw(Some(error.needed)).unwrap();
    assert_legible(&text(&drawing));
}
