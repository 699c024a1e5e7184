import { expect, test } from "vitest";
import { History } from "../../../../web/src/page/settings/history";
import { random } from "../../golden";

test("undo and redo walk through all changes and back, whatever is done (seeds 1 to 30)", () => {
  for (let seed = 1; seed <= 30; seed++) {
    const next = random(seed);
    const history = new History("0");
    // brute force: all states, and where we are
    let states = ["0"];
    let at = 0;
    for (let k = 1; k < 200; k++) {
      const dice = next();
      if (dice < 0.5) {
        history.record(String(k), "wind", 10_000 * k);
        states = [...states.slice(0, at + 1), String(k)];
        at++;
        if (at > 100) {
          states.shift();
          at--;
        }
      } else if (dice < 0.8) {
        expect(history.undo()).toBe(at > 0 ? states[--at] : null);
      } else expect(history.redo()).toBe(at + 1 < states.length ? states[++at] : null);
      expect([history.canUndo, history.canRedo]).toEqual([at > 0, at + 1 < states.length]);
    }
  }
});

test("a drag is one step, another kind of change is not", () => {
  const history = new History("calm");
  for (let k = 0; k < 50; k++) history.record(`wind ${k}`, "wind", 16 * k);
  history.record("winter", "season", 810);
  history.record("winter", "season", 900); // nothing new
  expect(history.undo()).toBe("wind 49");
  expect(history.undo()).toBe("calm");
  expect(history.undo()).toBeNull();
  expect(history.redo()).toBe("wind 49");
  history.record("gale", "wind", 920);
  expect(history.canRedo).toBe(false);
  expect(history.undo()).toBe("wind 49");
});

test("what others change is not undone", () => {
  const history = new History("calm");
  history.record("breeze", "wind", 0);
  history.adopt("gale of another visitor");
  history.record("storm", "wind", 100);
  expect(history.undo()).toBe("gale of another visitor");
});
