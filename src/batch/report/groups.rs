//! Rows that are drawn together.

use crate::batch::results::row::Row;

/// Rows of one scene, scheduler, settings and number of threads.
#[derive(Debug)]
pub(crate) struct Group<'a> {
    pub scene: &'a str,
    pub scheduler: &'a str,
    pub threads: usize,
    pub rows: Vec<&'a Row>,
    /// Number of the scheduler and settings, which have one colour on the whole page.
    pub kind: usize,
}

/// Rows in groups, in the order in which they come; and the names of the kinds.
pub(crate) fn groups(rows: &[Row]) -> (Vec<Group<'_>>, Vec<String>) {
    let mut groups: Vec<Group<'_>> = Vec::new();
    let mut kinds: Vec<(&str, &str)> = Vec::new();
    for row in rows {
        let kind = (row.scheduler.as_str(), row.settings.as_str());
        let number = kinds.iter().position(|known| *known == kind).unwrap_or_else(|| {
            kinds.push(kind);
            kinds.len() - 1
        });
        let is_its = |group: &&mut Group<'_>| group.scene == row.scene && group.kind == number;
        match groups.iter_mut().find(is_its) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group {
                scene: &row.scene,
                scheduler: &row.scheduler,
                threads: row.threads,
                rows: vec![row],
                kind: number,
            }),
        }
    }
    // Groups of one scene stand together.
    let mut scenes: Vec<&str> = Vec::new();
    for group in &groups {
        if !scenes.contains(&group.scene) {
            scenes.push(group.scene);
        }
    }
    groups.sort_by_key(|group| (scenes.iter().position(|scene| *scene == group.scene), group.kind));
    let name = |(scheduler, settings): &(&str, &str)| match settings.is_empty() {
        true => (*scheduler).to_owned(),
        false => format!("{scheduler}, {settings}"),
    };
    let names = kinds.iter().map(name).collect();
    (groups, names)
}

/// The scenes of some groups, in their order.
pub(crate) fn scenes<'a>(groups: &[Group<'a>]) -> Vec<&'a str> {
    let mut scenes: Vec<&str> = groups.iter().map(|group| group.scene).collect();
    scenes.dedup();
    scenes
}

impl Group<'_> {
    /// Seconds of the solves that gave a path, sorted.
    pub(crate) fn times(&self) -> Vec<f64> {
        let solved = self.rows.iter().filter(|row| row.is_solved());
        let mut times: Vec<f64> = solved.map(|row| row.solve_time.as_secs_f64().max(1e-6)).collect();
        times.sort_by(f64::total_cmp);
        times
    }
}
