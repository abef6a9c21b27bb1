//! A small image of hair on a plain head, drawn in memory.

use egui::ColorImage;
use glam::{Mat3, Vec3};
use lovelock_groom::{Bounds, HairFile};

use crate::window::theme;

/// Turn and nod of the view, radians: from the front, somewhat from the side and from above.
const VIEW: [f32; 2] = [-0.5, 0.2];
const HAIR: [f32; 3] = [0.62, 0.43, 0.24];
const SKIN: [f32; 3] = [0.46, 0.40, 0.37];
/// Margin of the image, as a fraction of its side.
const MARGIN: f32 = 0.06;

/// The pixels so far: colours, and how near to the eye each is.
struct Sketch {
    side: usize,
    colors: Vec<[f32; 3]>,
    nearness: Vec<f32>,
    /// Pixels of a point of the view: `scale * point + shift`.
    scale: f32,
    shift: [f32; 2],
}

/// Draws hair in metres with Y up and the face toward +Z.
pub(super) fn draw(hair: &HairFile, side: usize) -> ColorImage {
    let view = Mat3::from_rotation_x(VIEW[1]) * Mat3::from_rotation_y(VIEW[0]);
    let mut roots = Bounds::EMPTY;
    for root in hair.roots() {
        roots.include(root);
    }
    let [mut x, mut y, mut z] = roots.size().to_array();
    // The middle side, because a mohawk is longer than a head.
    if x > y {
        std::mem::swap(&mut x, &mut y);
    }
    if y > z {
        std::mem::swap(&mut y, &mut z);
    }
    let radius = 0.5 * x.max(y).max(1e-6);
    let head = head(roots.centre(), 0.94 * radius);

    let mut seen = Bounds::EMPTY;
    for &point in &hair.points {
        seen.include(view * point);
    }
    for &(centre, radius) in &head {
        seen.include(view * centre - radius);
        seen.include(view * centre + radius);
    }
    let size = seen.size().truncate().max_element().max(f32::MIN_POSITIVE);
    let scale = (1.0 - 2.0 * MARGIN) * side as f32 / size;
    let middle = 0.5 * side as f32;
    let shift = [middle - scale * seen.centre().x, middle + scale * seen.centre().y];
    let empty = theme::to_linear(theme::page());
    let mut sketch = Sketch {
        side,
        colors: vec![empty; side * side],
        nearness: vec![f32::NEG_INFINITY; side * side],
        scale,
        shift,
    };
    for &(centre, radius) in &head {
        sketch.ball(view * centre, radius);
    }
    for strand in 0..hair.strands() {
        for &[a, b] in hair.strand(strand).array_windows() {
            sketch.segment(view * a, view * b);
        }
    }
    let pixels = sketch.colors.into_iter().map(theme::from_linear).collect();
    ColorImage::new([side, side], pixels)
}

/// Balls that look like a head with a nose on a neck.
fn head(centre: Vec3, radius: f32) -> Vec<(Vec3, f32)> {
    let mut balls = vec![
        (centre, radius),
        (centre + radius * Vec3::new(0.0, -0.45, 0.25), 0.72 * radius),
        (centre + radius * Vec3::new(0.0, -0.3, 1.02), 0.16 * radius),
    ];
    balls.extend(
        (0..8).map(|k| (centre + radius * Vec3::new(0.0, -0.7 - 0.14 * k as f32, -0.2), 0.5 * radius)),
    );
    balls
}

impl Sketch {
    fn pixel(&self, point: Vec3) -> [f32; 2] {
        [self.scale * point.x + self.shift[0], self.shift[1] - self.scale * point.y]
    }

    fn put(&mut self, x: f32, y: f32, nearness: f32, color: [f32; 3]) {
        let side = self.side as f32;
        if !(0.0..side).contains(&x) || !(0.0..side).contains(&y) {
            return;
        }
        let at = y as usize * self.side + x as usize;
        if nearness > self.nearness[at] {
            self.nearness[at] = nearness;
            self.colors[at] = color;
        }
    }

    fn ball(&mut self, centre: Vec3, radius: f32) {
        let [x, y] = self.pixel(centre);
        let reach = (self.scale * radius).min(self.side as f32).ceil() as i32;
        for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
            let (right, up) = (dx as f32 / (self.scale * radius), -dy as f32 / (self.scale * radius));
            let front = 1.0 - right * right - up * up;
            if front > 0.0 {
                let front = front.sqrt();
                let light = 0.25 + 0.6 * (0.3 * right + 0.6 * up + 0.74 * front).max(0.0);
                let color = SKIN.map(|v| v * light);
                self.put(x + dx as f32, y + dy as f32, centre.z + radius * front, color);
            }
        }
    }

    fn segment(&mut self, a: Vec3, b: Vec3) {
        let along = (b - a).normalize_or_zero();
        // The light comes from above: hair across it is bright, as cylinders are.
        let across = (1.0 - along.dot(Vec3::new(0.2, 0.8, 0.55)).powi(2)).max(0.0).sqrt();
        let color = HAIR.map(|v| v * (0.15 + 0.7 * across));
        let ([x0, y0], [x1, y1]) = (self.pixel(a), self.pixel(b));
        let steps = (x1 - x0).abs().max((y1 - y0).abs()).min(4.0 * self.side as f32).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let t = step as f32 / steps as f32;
            self.put(x0 + t * (x1 - x0), y0 + t * (y1 - y0), a.z + t * (b.z - a.z), color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lovelock_groom::load_hair_bytes;

    #[test]
    fn hair_that_hangs_is_drawn_below_hair_that_stands() {
        let file = |along: f32| {
            let mut bytes = 60_i32.to_le_bytes().to_vec();
            for strand in 0..60 {
                bytes.extend(2_i32.to_le_bytes());
                let (sin, cos) = (0.1 * strand as f32).sin_cos();
                for point in [[0.1 * sin, 0.0, 0.1 * cos], [0.11 * sin, along, 0.11 * cos]] {
                    bytes.extend(point.into_iter().flat_map(f32::to_le_bytes));
                }
            }
            load_hair_bytes("a.data", &bytes).expect("hair")
        };
        // The mean row of the brownish pixels.
        let row = |hair: &HairFile| {
            let image = draw(hair, 64);
            let is_hair = |pixel: &egui::Color32| i32::from(pixel.r()) > i32::from(pixel.b()) + 40;
            let rows: Vec<usize> =
                (0..64 * 64).filter(|&at| is_hair(&image.pixels[at])).map(|at| at / 64).collect();
            assert!(rows.len() > 100, "{} pixels", rows.len());
            rows.iter().sum::<usize>() as f32 / rows.len() as f32
        };
        let (hangs, stands) = (row(&file(-0.25)), row(&file(0.25)));
        assert!(hangs > stands + 5.0, "{hangs} {stands}");
        // Points in one place, and large ones, are drawn too.
        draw(&file(1e-20), 16);
        draw(&file(1e12), 16);
    }
}
