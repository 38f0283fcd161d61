use super::*;

#[test]
fn tractions_are_those_of_the_reference_loads_and_training_is_apart_from_them() {
    let Some(folder) = sulcus_support::data("fem") else {
        return;
    };
    let organ = Organ::read(&folder, &|_, _| ()).expect("an organ");
    // As the README of the cases defines them, in millimetres.
    let reference = [
        ("tip_vertical", Vec3::new(36.0, 0.0, 44.62), -Vec3::z()),
        ("lateral", Vec3::new(20.0, 16.065, 42.0), -Vec3::y()),
    ];
    for (name, centre, direction) in reference {
        let weight = patch(centre * 1e-3, 8e-3, |normal| normal.dot(&direction) < 0.0);
        let (on_nodes, on_vertices) = traction(&organ, &direction, &weight).expect("loaded");
        let mut reader = csv::Reader::from_path(folder.join(format!("{name}_forces_unit.csv")))
            .expect("a table");
        let (mut off, mut size, mut rows) = (0.0, 0.0, 0);
        for row in reader.records() {
            let row: Vec<f64> = row
                .expect("a row")
                .iter()
                .map(|x| x.parse().expect("a number"))
                .collect();
            let (quad, vert) = (
                Vec3::new(row[4], row[5], row[6]),
                Vec3::new(row[7], row[8], row[9]),
            );
            off += (on_nodes[row[0] as usize] - quad).norm_squared();
            size += quad.norm_squared();
            if let Some(v) = organ.vertex_of.get(&(row[0] as u32)) {
                off += (on_vertices[*v] - vert).norm_squared();
                size += vert.norm_squared();
            }
            rows += 1;
        }
        let off = (off / size).sqrt();
        println!(
            "{name}: {rows} rows, forces differ by {:.2} % (integration)",
            100.0 * off
        );
        // A patch hardly larger than the elements: integration points at its rim count here or there.
        assert!(off < 0.05, "{name}: {off}");
        let total: Vec3 = on_nodes.iter().sum();
        assert!((total - direction).norm() < 1e-12);
    }
    let training = training(&organ, 60, 12);
    assert!(training.len() > 150, "{}", training.len());
    for load in &training {
        let [nodes, vertices] = [&load.on_nodes, &load.on_vertices].map(|f| f.iter().sum::<Vec3>());
        assert!(
            (nodes - vertices).norm() < 1e-12 && (nodes.norm() - 1.0).abs() < 1e-12,
            "{}",
            load.name
        );
    }
    for (name, centre, direction) in reference {
        // The nearest patch pushed nearly the same way: none is the reference load.
        let patches = training
            .iter()
            .filter(|load| load.name.starts_with("patch"));
        let near = patches.map(|load| {
            let along: Vec3 = load.on_nodes.iter().sum();
            (
                (middle(&organ, load) - centre * 1e-3).norm(),
                along.dot(&direction),
            )
        });
        let same = near
            .filter(|(_, along)| *along > 0.9)
            .map(|(d, _)| 1e3 * d)
            .fold(f64::INFINITY, f64::min);
        println!(
            "{name}: nearest training patch pushed alike (within 26 degrees) is {same:.1} mm away"
        );
        assert!(same > 2.0, "{name}: {same} mm");
    }
}

/// The mean place of a load, metres.
fn middle(organ: &Organ, load: &Traction) -> Vec3 {
    let places = organ.surface.vertices.iter().zip(&load.on_vertices);
    let (sum, total) = places.fold((Vec3::zeros(), 0.0), |(sum, total), (place, force)| {
        (sum + place * force.norm(), total + force.norm())
    });
    sum / total
}
