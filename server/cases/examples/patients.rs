//! Depths that the operator reads in generated mouths, zone by zone, against the prescribed ones.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use clap::Parser;
use sulcus_cases::mouth::{Examined, examine, mouth};
use sulcus_operator::habit::Habit;

/// How many of the zones that were read worst are listed at the end.
const FARTHEST: usize = 24;

/// Read every pocket of generated mouths with the simulated operator, and compare with the prescribed depths
#[derive(Parser)]
struct Arguments {
    /// Seed of the first patient
    #[arg(default_value_t = 1)]
    from: u64,
    /// Seed of the last patient
    #[arg(default_value_t = 20)]
    to: u64,
    /// Teeth as FDI numbers with commas, such as 36,37, or `all`
    #[arg(default_value = "all", value_parser = teeth)]
    teeth: Teeth,
    /// Habit of the operator, such as `heavy-hand`. The good operator without a habit
    habit: Option<Habit>,
}

/// FDI numbers of teeth; none for all teeth.
#[derive(Clone)]
struct Teeth(Vec<u8>);

/// Reads a list of teeth.
fn teeth(text: &str) -> Result<Teeth, std::num::ParseIntError> {
    let numbers = text.split(',').filter(|number| *number != "all");
    numbers.map(str::parse).collect::<Result<_, _>>().map(Teeth)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Arguments {
        from,
        to,
        teeth: Teeth(teeth),
        habit,
    } = Arguments::parse();

    let next = AtomicU64::new(from);
    let done: Mutex<Vec<(u64, Examined)>> = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed > to {
                        break;
                    }
                    let examined = examine(&mouth(seed, false, 3), &teeth, habit);
                    if from == to {
                        println!("{}\n{:?}", examined.toured, examined.inside);
                    }
                    println!("{}", line(seed, &examined));
                    done.lock()
                        .expect("no other thread panicked")
                        .push((seed, examined));
                }
            });
        }
    });
    let done = done.into_inner()?;
    let reads = || done.iter().flat_map(|(_, examined)| &examined.toured.reads);
    let read = || reads().filter(|read| read.called.is_some());
    let within = |most: f64| read().filter(|read| read.error().abs() <= most).count();
    let mut farthest: Vec<_> = done
        .iter()
        .flat_map(|(seed, examined)| examined.toured.reads.iter().map(move |read| (seed, read)))
        .filter(|(_, read)| read.called.is_some())
        .collect();
    farthest.sort_by(|a, b| b.1.error().abs().total_cmp(&a.1.error().abs()));
    for (seed, read) in farthest.iter().take(FARTHEST) {
        println!(
            "  patient {seed:2} {} {:13} {:+.2} mm",
            read.tooth,
            read.site.name(),
            read.error() * 1e3
        );
    }
    println!(
        "all: {} of {} zones read, {} within 0.2 mm, {} within 0.3 mm, {} within 0.5 mm",
        read().count(),
        reads().count(),
        within(0.2e-3),
        reads().filter(|read| read.holds()).count(),
        within(0.5e-3)
    );
    Ok(())
}

/// One patient: how many zones hold, the worst ones, and how near to the meshes' insides.
fn line(seed: u64, examined: &Examined) -> String {
    let toured = &examined.toured;
    let visited = || toured.reads.iter().filter(|read| read.called.is_some());
    let mut worst: Vec<_> = toured
        .reads
        .iter()
        .filter(|read| read.time > 0.0 && !read.holds())
        .map(|read| {
            format!(
                "{} {} {:+.2}",
                read.tooth,
                read.site.name(),
                read.error() * 1e3
            )
        })
        .collect();
    worst.truncate(12);
    let inside = examined
        .inside
        .iter()
        .map(|(_, inside, allowed)| inside - allowed);
    format!(
        "patient {seed}: {} of {} within 0.3 mm ({}), mean error {:+.3} mm; {:.0} s, done {}, {} entries, heaviest {:.2} N, {} exhausted; inside a tooth {:+.3} mm of what is allowed",
        visited().filter(|read| read.holds()).count(),
        visited().count(),
        worst.join(", "),
        visited().map(|read| read.error()).sum::<f64>() / visited().count().max(1) as f64 * 1e3,
        toured.time,
        toured.done,
        toured.entries,
        visited().fold(0.0, |most: f64, read| most.max(read.most_force)),
        toured.exhausted,
        inside.fold(f64::NEG_INFINITY, f64::max) * 1e3
    )
}
