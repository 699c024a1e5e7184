// Makes the graphics context while the modules of the page are loading, as that takes a tenth of a second or more where the
// processor draws. Without antialiasing: where that is wanted, the canvas is renewed (src/page/forest/graphics.ts). This is a module
// because modules run in the order of the page, and do not hold it up.
document.getElementById("view").getContext("webgl2", { antialias: false, powerPreference: "high-performance" });
