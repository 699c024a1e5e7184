"""The Galewood service: trees, jobs, tables and forest streams over HTTP and WebSocket."""
