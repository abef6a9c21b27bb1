//! The wisp simulator: rigid links, collisions, density-grid repulsion and wind.
