//! Reviews as files: every given row is read back, and invalid data are refused.

use sulcus_view::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewFile, ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, ViewError, Weight,
};

use crate::rows::count_rows;

fn tetrahedron() -> MeshPicture {
    MeshPicture {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        colour: [200, 100, 100],
        vertex_colours: Vec::new(),
    }
}

fn part(kind: PartKind, name: &str, yields: bool) -> PartPicture {
    PartPicture {
        kind,
        name: name.into(),
        mesh: tetrahedron(),
        yields,
    }
}

/// A tooth, its gingiva, a tongue; a probe and a mirror.
fn picture() -> ReviewPicture {
    let eye = Eye {
        at: [50.0, 0.0, 50.0],
        on: [0.0; 3],
    };
    let tool = |name: &str| ToolPicture {
        name: name.into(),
        mesh: MeshPicture {
            vertex_colours: vec![[255; 3]; 4],
            ..tetrahedron()
        },
        tip: [0.0; 3],
    };
    ReviewPicture {
        name: "a session".into(),
        about: "what it **is**".into(),
        tools: vec![tool("probe"), tool("mirror")],
        probe: 0,
        parts: vec![
            part(PartKind::Tooth, "tooth 36", false),
            part(PartKind::Gingiva, "gingiva 36", true),
            part(PartKind::Tongue, "tongue", true),
        ],
        teeth: vec![Label {
            at: [0.0, 0.0, 2.0],
            text: "36".into(),
        }],
        span_ns: [1_000_000, 3_500_000_000],
        reading_band_n: Some([0.2, 0.25]),
        trauma_n: Some(0.5),
        overview: eye,
        retraction: Some(eye),
        close_up: Some(eye),
        arrow_mm_per_n: 10.0,
        work: vec!["passes".into()],
        slider: Slider::Start,
    }
}

fn at(tick: i64) -> Moment {
    Moment {
        tick,
        session_ns: tick * 1_000_000,
    }
}

fn numbers() -> Numbers {
    Numbers {
        force_n: vec![0.2, 1.0],
        torque_nmm: vec![1.0, 30.0],
        depth_mm: f64::NAN,
        prescribed_mm: 4.0,
        floor_n: 0.2,
        work: vec![3.0],
    }
}

fn frame(tick: i64) -> FramePicture {
    let standing = Standing {
        at: [tick as f32, 0.0, 0.0],
        turned: [0.0, 0.0, 0.0, 1.0],
    };
    let arrow = Arrow {
        at: [0.0; 3],
        force_n: [0.0, 0.0, 0.3],
        by: PartKind::Gingiva,
    };
    let probe = ToolStanding {
        graphic: standing,
        haptic: (tick % 2 == 0).then_some(standing),
        tips: [[0.0; 3], [0.0, 0.0, -1.0]],
        push: (tick % 3 == 0).then_some(arrow),
    };
    FramePicture {
        tools: vec![Some(probe), None],
        // Any number of contacts, also none.
        contacts: vec![vec![arrow; (tick % 4) as usize], Vec::new()],
        close_up: standing,
    }
}

#[test]
fn every_row_is_read_back() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.rrd");
    let mut file = ReviewFile::create(&path, picture()).expect("begins");
    let mut moving = tetrahedron().vertices;
    for tick in 1..=3500 {
        file.tick(at(tick), &numbers()).expect("fits");
        if tick % 50 == 0 {
            file.frame(at(tick), &frame(tick)).expect("fits");
            moving[3][2] += 0.1;
            file.part(at(tick), 2, &moving).expect("fits");
        }
        if tick == 2000 {
            file.sites(at(tick), &picture().teeth);
        }
        if tick % 1000 == 0 {
            file.event(at(tick), Weight::Warning, "heavy");
            file.state(at(tick), Lane::Zone, "trauma");
            file.called(at(tick), 4.0);
        }
    }
    let said = file.finish().expect("ends");
    let (rows, blueprints) = count_rows(&path).expect("reads");
    assert_eq!(blueprints, 1);
    for (entity, expected) in [
        ("/plots/force", 3500),
        ("/plots/torque", 3500),
        ("/plots/depth", 3500),
        ("/plots/floor_force", 3500),
        ("/plots/work", 3500),
        ("/plots/depth/called", 3),
        ("/tools/probe", 70),
        ("/tools/mirror", 70),
        ("/hands/mirror", 70),
        ("/offsets/probe", 70),
        ("/contacts/probe", 70),
        ("/forces/on_probe", 70),
        ("/close_up", 70),
        ("/events", 3),
        ("/lanes/force_on_floor", 3),
    ] {
        assert_eq!(rows[entity].timed, expected, "{entity}");
        assert_eq!(said[entity], expected, "{entity}");
    }
    // The session has 3.5 s in columns of a second, and the constant part is another chunk.
    assert!(rows.values().all(|of| of.chunks <= 5), "{rows:?}");
    assert_eq!(rows["/mouth/teeth/tooth_36"].constant, 1);
    assert_eq!(rows["/labels/teeth"].constant, 1);
    assert_eq!(rows["/labels/sites"].timed, 1);
    assert_eq!(rows["/mouth/gingiva/gingiva_36"].constant, 1, "never moved");
    // One vertex moves. Its patches are written at the beginning, and each time it has moved.
    let patches = rows.iter();
    let patches = patches.filter(|(path, _)| path.starts_with("/mouth/tongue/tongue/"));
    let of: Vec<u64> = patches.map(|(_, of)| of.timed).collect();
    assert!(
        of.contains(&71) && of.iter().all(|rows| [1, 71].contains(rows)),
        "{of:?}"
    );
    assert!(
        !rows.contains_key("/mouth/tongue/tongue"),
        "it would stand beside its patches"
    );
    assert_eq!(rows["/plots/floor_force/trauma"].timed, 2);
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.rrd");
    let refused = |picture: ReviewPicture| {
        let error = ReviewFile::create(&path, picture).expect_err("refused");
        assert!(!path.exists(), "nothing is begun");
        error.to_string()
    };
    let mut wrong = picture();
    wrong.parts[1].mesh.triangles[0] = [0, 1, 4];
    assert_eq!(
        refused(wrong),
        "gingiva 36: largest vertex index of a triangle, plus one is 5, expected 4"
    );
    let mut wrong = picture();
    wrong.tools[0].mesh.vertex_colours.pop();
    assert_eq!(refused(wrong), "probe: vertex_colours is 3, expected 4");
    let mut file = ReviewFile::create(&path, picture()).expect("begins");
    let mut few = numbers();
    few.force_n.pop();
    let told = file.tick(at(1), &few).expect_err("one force").to_string();
    assert_eq!(told, "tick: force_n is 1, expected 2");
    let mut one = frame(1);
    one.tools.pop();
    assert!(file.frame(at(1), &one).is_err());
    for (part, vertices) in [(0, 4), (9, 4), (2, 3)] {
        let told = file.part(at(1), part, &vec![[0.0; 3]; vertices]);
        assert!(matches!(told, Err(ViewError::Fit { .. })), "{told:?}");
    }
}
