/** Starts a server on a free port with its own data folder, unless BASE_URL is set, and waits until its species are
 * ready. It has only one built-in species, to save time; an uploaded tree makes the forest a mixed one. */
import { cpSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, relative, resolve } from "node:path";
import { freePort, serve, stop, untilReady } from "./server";

const OURS = resolve(__dirname, "../../assets/species");
const ENOUGH = ["poplar"];

/** Creates a species folder under `data` with a subset of the built-in species and the tables shipped with them. */
function fewSpecies(data: string): string {
  const folder = join(data, "few-species");
  mkdirSync(folder, { recursive: true });
  const all = JSON.parse(readFileSync(join(OURS, "species.json"), "utf8")) as { id: string; file: string }[];
  const few = all.filter(({ id }) => ENOUGH.includes(id));
  writeFileSync(join(folder, "species.json"), JSON.stringify(few));
  const wanted = few.flatMap(({ id, file }) => [`${id}.`, file]);
  for (const path of readdirSync(OURS, { recursive: true, withFileTypes: true })) {
    if (!path.isFile() || !wanted.some((start) => path.name.startsWith(start))) continue;
    const from = join(path.parentPath, path.name);
    cpSync(from, join(folder, relative(OURS, from)));
  }
  cpSync(join(OURS, "light"), join(folder, "light"), { recursive: true });
  return folder;
}

export default async function setup(): Promise<() => Promise<void>> {
  let end = async () => {};
  if (!process.env.BASE_URL) {
    const port = await freePort();
    const kept = process.env.E2E_DATA_DIR;
    const data = kept ?? mkdtempSync(join(tmpdir(), "galewood-e2e-"));
    process.env.GALEWOOD_SPECIES_DIR = fewSpecies(data);
    const server = serve(port, data);
    process.env.SERVER_DATA = data;
    process.env.BASE_URL = `http://127.0.0.1:${port}`;
    end = async () => {
      await stop(server);
      if (!kept) rmSync(data, { recursive: true, force: true });
    };
  }
  try {
    await untilReady(process.env.BASE_URL);
  } catch (error) {
    await end();
    throw error;
  }
  return end;
}
