import { expect, test } from "vitest";
import { embedCode } from "../../../web/src/page/sharing/embedCode";
import { settingsFromQuery } from "../../../web/src/page/settings/settings";
import { soundOf } from "../../../web/src/page/sound";
import { presenceWords } from "../../../web/src/page/sharing/sharingCard";
import { forestUrl } from "../../../web/player/src/worker/stream/forestUrl";

test("the embed code is one safe iframe of the link", () => {
  const code = embedCode('https://forest.example/?trees=9&wind={"version":1}&share=a');
  const source = /^<iframe src="([^"]*)" [^<>]*><\/iframe>$/.exec(code)?.[1]?.replaceAll("&amp;", "&");
  const url = new URL(source ?? "");
  expect(Object.fromEntries(url.searchParams)).toEqual({ trees: "9", wind: '{"version":1}', share: "a", embed: "1" });
});

test("an embedded page has no panel", () => {
  expect(settingsFromQuery("?embed=1")).toMatchObject({ embed: true, panel: false });
  expect(settingsFromQuery("?embed=0")).toMatchObject({ embed: false, panel: true });
});

test("stronger wind is louder and higher, up to a limit", () => {
  let before = soundOf(0);
  expect(before.gain).toBe(0);
  for (let speed = 1; speed <= 25; speed++) {
    const now = soundOf(speed);
    expect(now.gain).toBeGreaterThan(before.gain);
    expect(now.leaves_hz).toBeGreaterThan(before.leaves_hz);
    before = now;
  }
  expect(soundOf(60)).toEqual(soundOf(25));
});

test("the words of presence", () => {
  expect([null, 1, 2].map(presenceWords)).toEqual([
    "Connecting …",
    "Nobody else is here yet.",
    "2 people are here, you included.",
  ]);
});

test("the socket's address names a shared forest, so that a proxy sends all its clients to one server", () => {
  const share = { id: "ab_1-2", replant: false, about: {} };
  const shared = forestUrl("wss://trees.example.org/in/ws/forest", share);
  expect(shared).toBe("wss://trees.example.org/in/ws/forest?share=ab_1-2");
  expect(forestUrl("ws://localhost:8000/ws/forest", null)).toBe("ws://localhost:8000/ws/forest");
});
