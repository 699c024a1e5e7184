/** Prints as JSON the time per frame of the wind at 10,000 trees: `npm run --silent bench-wind`. */
import { benchWind } from "./bench/wind";

benchWind(10_000, 30); // warm-up
console.log(JSON.stringify({ trees: 10_000, ...benchWind() }, null, 2));
