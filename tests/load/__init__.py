"""Combined load on a real server: `scripts/load-test --help` (docs/scaling.md)."""
