"""What every frame computes, in TypeScript too: the wind, the modal model, the paper's search."""
