//! Draws limp hair that grows in rows on a plate and has fallen, seen along the plate:
//! `brush WITH.png WITHOUT.png`, with and without the density grid.

use image::{Rgb, RgbImage};

mod hair;

/// Image size in pixels, and pixels per metre.
const SIZE: (u32, u32) = (480, 640);
const SCALE: f32 = 1700.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    for grid in [true, false] {
        let out = args.next().ok_or("brush WITH.png WITHOUT.png")?;
        let (guides, kept) = hair::fall(&hair::settings(grid), 240);
        let mut image = RgbImage::from_pixel(SIZE.0, SIZE.1, Rgb([28, 29, 33]));
        for g in 0..guides.count() {
            // Rows from the lowest, dark, to the highest, light.
            let shade = guides.point(g, 0).y / 0.11;
            let color = Rgb([
                (110.0 + 130.0 * shade) as u8,
                (60.0 + 100.0 * shade) as u8,
                (40.0 + 50.0 * shade) as u8,
            ]);
            for i in 1..guides.points_per_guide {
                let (a, b) = (guides.point(g, i - 1), guides.point(g, i));
                for k in 0..40 {
                    let p = a.lerp(b, k as f32 / 40.0);
                    let (x, y) = (0.5 * SIZE.0 as f32 + p.z * SCALE, 240.0 - p.y * SCALE);
                    if x >= 0.0 && y >= 0.0 && (x as u32) < SIZE.0 && (y as u32) < SIZE.1 {
                        image.put_pixel(x as u32, y as u32, color);
                    }
                }
            }
        }
        image.save(&out)?;
        println!("{out}: {:.0} % of the rest volume remains", 100.0 * kept);
    }
    Ok(())
}
