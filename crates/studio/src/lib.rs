//! The engine: project, session, commands, events, clock and the headless loop.
