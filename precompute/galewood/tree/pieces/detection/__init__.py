"""Which connected pieces the parts of a file have, with their colours and shapes."""
