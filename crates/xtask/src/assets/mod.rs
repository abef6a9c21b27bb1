//! `cargo xtask assets`: makes the dancer, `assets/dancer.glb`.

mod dance;
mod figure;
mod glb;
mod head;
mod ik;
mod mesh;
mod paint;
mod preview;
mod remesh;
mod rig;
mod score;
mod sdf;
mod weights;

use std::path::Path;

use glam::Vec3;

/// Makes every shipped asset anew; with a preview folder, also writes pictures of the figure there.
pub(crate) fn run(preview: Option<&Path>) -> anyhow::Result<()> {
    let figure = figure::Figure::new();
    let distance = |p: Vec3| figure.distance(p);
    let t = std::time::Instant::now();
    let mut net = mesh::surface_nets(&distance);
    eprintln!("nets {} {:?}", net.positions.len(), t.elapsed());
    use rayon::prelude::*;
    net.positions.par_iter_mut().for_each(|p| *p = mesh::project(&distance, *p));
    eprintln!("projected {:?}", t.elapsed());
    remesh::remesh(&mut net, &distance, &figure::edge_length, 6);
    remesh::snap(&mut net, &distance, &paint::seam, &figure::edge_length);
    eprintln!("remeshed {} {:?}", net.positions.len(), t.elapsed());
    let normals = mesh::normals(&distance, &net.positions);
    eprintln!("projected {:?}", t.elapsed());
    let colours: Vec<Vec3> = net.positions.iter().map(|p| paint::colour(*p)).collect();
    let joints = rig::joints();
    let influences = weights::influences(&net, joints.len());
    eprintln!("weights {:?}", t.elapsed());
    let clips = vec![score::dance().sample(&joints), score::idle().sample(&joints)];
    eprintln!("clips {:?}", t.elapsed());
    let scalp = net
        .positions
        .iter()
        .map(|p| if p.y < 1.45 { 0.0 } else { sdf::smoothstep(-0.004, 0.004, head::inside_hairline(*p)) })
        .collect();
    let dancer = glb::Dancer {
        positions: net.positions.clone(),
        normals: normals.clone(),
        colours: colours.clone(),
        scalp,
        influences,
        triangles: net.triangles.clone(),
        joints,
        clips,
    };
    let bytes = glb::write(&dancer)?;
    eprintln!("bytes {}", bytes.len());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/dancer.glb");
    std::fs::write(&path, &bytes)?;
    if let Some(folder) = preview {
        std::fs::create_dir_all(folder)?;
        let view = preview::View {
            positions: &net.positions,
            normals: &normals,
            colours: &colours,
            triangles: &net.triangles,
        };
        pictures(&view, &dancer.scalp, folder)?;
        contact_sheet(&dancer, folder)?;
    }
    Ok(())
}

fn pictures(view: &preview::View, scalp: &[f32], folder: &Path) -> anyhow::Result<()> {
    let v = Vec3::new;
    let around = |angle: f32, distance: f32, centre: Vec3, up: f32| {
        centre + v(angle.to_radians().sin() * distance, up, angle.to_radians().cos() * distance)
    };
    let body = v(0.0, 0.86, 0.0);
    let mut canvas = preview::Canvas::new(2000, 1000);
    for (i, angle) in [0.0, 45.0, 90.0, 180.0].into_iter().enumerate() {
        canvas.draw(view, (around(angle, 5.0, body, 0.1), body, 0.36), [i * 500, 0, 500, 1000]);
    }
    canvas.save(&folder.join("body.png"))?;
    let head = v(0.0, 1.58, 0.01);
    let mut canvas = preview::Canvas::new(1800, 1350);
    let shots = [(0.0, 0.0), (35.0, 0.02), (90.0, 0.0), (180.0, 0.0), (140.0, 0.1), (-25.0, -0.12)];
    for (i, (angle, up)) in shots.into_iter().enumerate() {
        canvas.draw(view, (around(angle, 1.1, head, up), head, 0.25), [i % 3 * 600, i / 3 * 675, 600, 675]);
    }
    canvas.save(&folder.join("head.png"))?;
    let painted: Vec<Vec3> =
        view.colours.iter().zip(scalp).map(|(c, s)| c.lerp(Vec3::new(0.05, 0.03, 0.02), 0.9 * s)).collect();
    let view = &preview::View { colours: &painted, ..*view };
    let mut canvas = preview::Canvas::new(1800, 675);
    for (i, (angle, up)) in [(20.0, 0.05), (80.0, 0.0), (165.0, 0.1)].into_iter().enumerate() {
        canvas.draw(view, (around(angle, 1.1, head, up), head, 0.25), [i * 600, 0, 600, 675]);
    }
    canvas.save(&folder.join("scalp.png"))?;
    let mut canvas = preview::Canvas::new(1800, 1200);
    let details = [
        (v(0.09, 1.36, 0.0), 20.0, 0.25, 0.9),
        (v(0.09, 1.36, 0.0), 100.0, 0.15, 0.9),
        (v(0.09, 1.36, 0.0), 180.0, 0.1, 0.9),
        (v(0.60, 0.97, 0.02), 20.0, 0.1, 0.6),
        (v(0.08, 0.06, 0.03), 50.0, 0.25, 0.8),
        (v(0.0, 0.86, 0.0), 10.0, 0.0, 1.2),
    ];
    for (i, (centre, angle, up, distance)) in details.into_iter().enumerate() {
        canvas.draw(view, (around(angle, distance, centre, up), centre, 0.42), [i % 3 * 600, i / 3 * 600, 600, 600]);
    }
    canvas.save(&folder.join("detail.png"))?;
    Ok(())
}

fn contact_sheet(dancer: &glb::Dancer, folder: &Path) -> anyhow::Result<()> {
    let clip = &dancer.clips[0];
    let mut canvas = preview::Canvas::new(1600, 1620);
    for frame in 0..24 {
        let key = frame * (clip.times.len() - 1) / 24;
        let (positions, normals) = skinned(dancer, clip, key);
        let view = preview::View {
            positions: &positions,
            normals: &normals,
            colours: &dancer.colours,
            triangles: &dancer.triangles,
        };
        let target = Vec3::new(0.0, 0.95, 0.0);
        canvas.draw(
            &view,
            (Vec3::new(0.6, 1.3, 6.0), target, 0.36),
            [frame % 8 * 200, frame / 8 * 540, 200, 540],
        );
    }
    canvas.save(&folder.join("dance.png"))
}

fn skinned(dancer: &glb::Dancer, clip: &glb::SampledClip, key: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let pose =
        dance::LocalPose { rotations: clip.rotations.iter().map(|r| r[key]).collect(), hips: clip.hips[key] };
    let world = dance::world_of(&dancer.joints, &pose);
    let mut out = (Vec::new(), Vec::new());
    for (i, influences) in dancer.influences.iter().enumerate() {
        let (mut p, mut n) = (Vec3::ZERO, Vec3::ZERO);
        for (joint, weight) in influences {
            let (q, t) = world[*joint as usize];
            let w = f32::from(*weight) / 65535.0;
            p += (q * (dancer.positions[i] - dancer.joints[*joint as usize].rest) + t) * w;
            n += (q * dancer.normals[i]) * w;
        }
        out.0.push(p);
        out.1.push(n.normalize_or(Vec3::Y));
    }
    out
}
