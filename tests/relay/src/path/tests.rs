use super::*;

const MS: u64 = 1_000_000;

fn ms(value: u64) -> Duration {
    Duration::from_millis(value)
}

/// Arrivals of `count` packets of 120 bytes, one each millisecond.
fn arrivals(path: &mut Path, count: u64) -> Vec<(u64, Option<u64>)> {
    (0..count)
        .map(|k| match path.send(k * MS, 120) {
            Fate::Arrives { at_ns, .. } => (k, Some(at_ns)),
            _ => (k, None),
        })
        .collect()
}

#[test]
fn without_conditions_every_packet_arrives_at_once() {
    let mut path = Path::new(Conditions::default(), 1);
    assert!(
        arrivals(&mut path, 100)
            .iter()
            .all(|&(k, at)| at == Some(k * MS))
    );
    assert_eq!(path.counts().arrived, 100);
}

#[test]
fn the_same_seed_gives_the_same_fates_and_another_seed_others() {
    let conditions = crate::Network::WifiBad.up();
    let of = |seed| arrivals(&mut Path::new(conditions, seed), 5000);
    assert_eq!(of(7), of(7));
    assert_ne!(of(7), of(8));
}

#[test]
fn delays_are_uniform_about_their_mean() {
    let conditions = Conditions {
        delay: ms(10),
        jitter: ms(2),
        ..Conditions::default()
    };
    let mut path = Path::new(conditions, 2);
    let delays: Vec<f64> = arrivals(&mut path, 20_000)
        .into_iter()
        .filter_map(|(k, at)| at.map(|at| (at - k * MS) as f64 / MS as f64))
        .collect();
    let count = delays.len() as f64;
    let mean = delays.iter().sum::<f64>() / count;
    let variance = delays.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / count;
    // Five standard errors of 20,000 draws; the variance of a uniform distribution of width 4 is 16/12.
    assert!((mean - 10.0).abs() < 0.045, "{mean}");
    assert!((variance - 16.0 / 12.0).abs() < 0.05, "{variance}");
    assert!(delays.iter().all(|d| (8.0..=12.0).contains(d)));
    let is_reordered = path.counts().reordered;
    assert!(is_reordered > 5000, "{is_reordered}");
}

#[test]
fn in_order_no_packet_overtakes() {
    let conditions = Conditions {
        delay: ms(10),
        jitter: ms(8),
        reorder: false,
        ..Conditions::default()
    };
    let mut path = Path::new(conditions, 3);
    let mut came: Vec<u64> = arrivals(&mut path, 2000)
        .into_iter()
        .filter_map(|(_, at)| at)
        .collect();
    assert!(came.is_sorted());
    assert_eq!(path.counts().reordered, 0);
    // Slots of 16 ms: delays of 2 to 17 ms, and 16 packets in each slot after the first packet.
    let delays: Vec<u64> = came
        .iter()
        .zip(0..)
        .map(|(at, k)| (at - k * MS) / MS)
        .collect();
    assert_eq!(
        (delays.iter().min(), delays.iter().max()),
        (Some(&2), Some(&17))
    );
    came.dedup();
    assert_eq!(came.len(), 1 + 2000 / 16);
}

#[test]
fn losses_have_the_stated_share_and_length() {
    for (loss, burst) in [(0.02, 1.0), (0.05, 4.0), (0.3, 10.0)] {
        let conditions = Conditions {
            loss,
            burst,
            ..Conditions::default()
        };
        let mut path = Path::new(conditions, 4);
        let sent = 400_000;
        let is_lost: Vec<bool> = arrivals(&mut path, sent)
            .iter()
            .map(|(_, at)| at.is_none())
            .collect();
        let runs = is_lost
            .windows(2)
            .filter(|pair| !pair[0] && pair[1])
            .count();
        let lost = path.counts().lost as f64;
        let share = lost / sent as f64;
        let length = lost / runs as f64;
        // The number of runs is about 6,000 to 12,000: five standard errors are about 6 %.
        assert!((share / loss - 1.0).abs() < 0.06, "{share} of {loss}");
        assert!((length / burst - 1.0).abs() < 0.06, "{length} of {burst}");
    }
}

#[test]
fn a_thin_link_passes_its_rate_and_drops_what_would_wait_too_long() {
    let conditions = Conditions {
        rate: Some(800_000),
        queue: ms(200),
        ..Conditions::default()
    };
    let mut path = Path::new(conditions, 5);
    let came = arrivals(&mut path, 10_000);
    let wait = |(k, at): &(u64, Option<u64>)| at.map(|at| at - k * MS);
    let longest = came.iter().filter_map(wait).max().expect("an arrival");
    // A packet of 148 bytes takes 1.48 ms.
    assert!(longest <= 202 * MS, "{longest}");
    let bits = path.counts().arrived * 148 * 8;
    assert!(
        (7_900_000..=8_200_000).contains(&bits),
        "{bits} bits in 10.2 s"
    );
    assert!(path.counts().overflow > 3000);
}

#[test]
fn a_stall_holds_packets_until_its_end() {
    let conditions = Conditions {
        stall: Some((ms(100), ms(30))),
        reorder: false,
        ..Conditions::default()
    };
    let mut path = Path::new(conditions, 6);
    for (k, at) in arrivals(&mut path, 300) {
        let into = k % 100;
        let expected = if into < 70 { k } else { k - into + 100 };
        assert_eq!(at, Some(expected * MS));
    }
}

#[test]
fn a_cut_path_loses_every_packet_and_a_joined_one_none() {
    let mut path = Path::new(Conditions::default(), 7);
    path.cut(true);
    assert_eq!(path.send(0, 100), Fate::Cut);
    path.cut(false);
    assert!(matches!(path.send(1, 100), Fate::Arrives { .. }));
    assert_eq!((path.counts().cut, path.counts().arrived), (1, 1));
}

#[test]
fn duplicates_arrive_after_their_first_copy() {
    let conditions = Conditions {
        delay: ms(5),
        jitter: ms(5),
        duplicate: 0.5,
        ..Conditions::default()
    };
    let mut path = Path::new(conditions, 8);
    for k in 0..1000 {
        let Fate::Arrives { at_ns, again_ns } = path.send(k * MS, 10) else {
            panic!("lost");
        };
        assert!(again_ns.is_none_or(|again| again >= at_ns));
    }
    // Five standard errors of a share of one half.
    let duplicated = path.counts().duplicated;
    assert!((420..=580).contains(&duplicated), "{duplicated}");
}
