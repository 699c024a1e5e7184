/** Prints, as JSON, how long the wind of 10,000 trees takes in one frame: `npm run --silent bench-wind`. */
import { benchWind } from "./bench/wind";

benchWind(10_000, 30); // lets the engine compile
console.log(JSON.stringify({ trees: 10_000, ...benchWind() }, null, 2));
