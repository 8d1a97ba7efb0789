//! MotionBenchMaker's problems: `file` reads them, `scene` writes each as a scene of Foliate, `run` solves them, `table` sums up.
//!
//! Source: Chamzas et al., *MotionBenchMaker: A Tool to Generate and Benchmark Motion Planning Datasets* (RA-L 2022).

pub mod file;
pub mod run;
pub mod scene;
pub mod table;
