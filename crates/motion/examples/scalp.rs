//! Draws the head of a character from the front, the side and behind, with its scalp mask in red.
//! `scalp BODY OUT.png`.

use std::path::Path;

use glam::Vec3;
use image::{Rgb, RgbImage};
use lovelock_motion::{head_mesh, load_character};

const CELL: u32 = 400;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [body, out] = args.as_slice() else { return Err("scalp BODY OUT.png".into()) };
    let head = head_mesh(&load_character(Path::new(body))?.body);
    let low = head.positions.iter().fold(Vec3::INFINITY, |a, &b| a.min(b));
    let high = head.positions.iter().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
    let scale = CELL as f32 * 0.9 / (high - low).max_element();
    println!("{} vertices, {:.3} m, guessed {}", head.positions.len(), high - low, head.scalp_is_guessed);
    let mut image = RgbImage::from_pixel(CELL * 3, CELL, Rgb([24, 24, 28]));
    let mut depth = vec![f32::MIN; (CELL * 3 * CELL) as usize];
    for triangle in &head.triangles {
        let [a, b, c] = triangle.map(|v| v as usize);
        // Enough samples to close gaps in the image; this is a viewing tool, not a renderer.
        for k in 0..400 {
            let (u, v) = ((k % 20) as f32 / 19.0, (k / 20) as f32 / 19.0);
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let w = [1.0 - u - v, u, v];
            let mix = |values: &[Vec3]| values[a] * w[0] + values[b] * w[1] + values[c] * w[2];
            let (p, n) = (mix(&head.positions) - 0.5 * (low + high), mix(&head.normals));
            let mask = head.scalp[a] * w[0] + head.scalp[b] * w[1] + head.scalp[c] * w[2];
            for (view, (across, toward)) in [(p.x, p.z), (-p.z, p.x), (-p.x, -p.z)].into_iter().enumerate() {
                let x = CELL as f32 * (view as f32 + 0.5) + across * scale;
                let y = CELL as f32 * 0.5 - p.y * scale;
                let (x, y) = (x as u32, y as u32);
                if x / CELL != view as u32 || y >= CELL || depth[(y * CELL * 3 + x) as usize] >= toward {
                    continue;
                }
                depth[(y * CELL * 3 + x) as usize] = toward;
                let shade = 0.55 + 0.4 * n.normalize_or_zero().dot(Vec3::new(0.4, 0.6, 0.3));
                let color = Vec3::new(230.0, 210.0 - 150.0 * mask, 200.0 - 150.0 * mask) * shade;
                image.put_pixel(x, y, Rgb(color.to_array().map(|v| v.clamp(0.0, 255.0) as u8)));
            }
        }
    }
    image.save(out)?;
    Ok(())
}
