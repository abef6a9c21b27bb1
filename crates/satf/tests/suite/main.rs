//! Tests of hair clusters with answers that are known on paper, each with a control that fails for the wrong formula.

mod boundaries;
mod clusters;
mod files;
mod hair;
mod records;
mod shading;
mod shapes;
mod tracing;

use std::sync::OnceLock;

use lovelock_satf::Database;

/// The database, made once for all tests.
fn database() -> &'static Database {
    static DATABASE: OnceLock<Database> = OnceLock::new();
    DATABASE.get_or_init(|| Database::build(&|_| ()))
}
