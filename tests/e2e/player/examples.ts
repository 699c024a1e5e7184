/** Serves and bundles the examples of the package `galewood` for their tests. */
import { existsSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { createServer, type IncomingMessage, request as ask, type ServerResponse } from "node:http";
import { connect } from "node:net";
import { createRequire } from "node:module";
import type { AddressInfo } from "node:net";
import { extname, join } from "node:path";
import { pathToFileURL } from "node:url";
import { REPOSITORY } from "../server";

export const EXAMPLES = join(REPOSITORY, "web/player/examples");
const TREES = join(REPOSITORY, "assets/species/shipped");
const LIGHT_TREES = join(REPOSITORY, "assets/species/light");
const REPORTS = "/violations";

const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".json": "application/json",
  ".glb": "model/gltf-binary",
};

export interface Site {
  readonly base: string;
  /** What browsers reported of the policy. */
  readonly violations: string[];
  close(): void;
}

/** Passes a request on to a service. */
function passOn(service: string, request: IncomingMessage, answer: ServerResponse): void {
  const { url, headers, method } = request;
  const passed = ask(new URL(url ?? "/", service), { headers, method }, (reply) => {
    answer.writeHead(reply.statusCode ?? 500, reply.headers);
    reply.pipe(answer);
  });
  passed.on("error", () => answer.writeHead(502).end());
  request.pipe(passed);
}

/**
 * Serves `folder` at /, the packages at /node_modules/ and the built-in trees at /trees/. `service`:
 * what answers at /api/ and /ws/. `policy`: the Content-Security-Policy of all files.
 */
export async function site(folder: string, { service, policy }: { service?: string; policy?: string } = {}): Promise<Site> {
  const violations: string[] = [];
  const security: Record<string, string> = policy ? { "content-security-policy": `${policy}; report-uri ${REPORTS}` } : {};
  const fileOf = (path: string): string => {
    if (path.startsWith("/trees/")) return join(TREES, path.slice("/trees/".length));
    if (path.startsWith("/light/")) return join(LIGHT_TREES, path.slice("/light/".length));
    if (!path.startsWith("/node_modules/")) return join(folder, path);
    return join(REPOSITORY, path);
  };
  const server = createServer((request, answer) => {
    const { pathname } = new URL(request.url ?? "/", "http://localhost");
    if (service && pathname.startsWith("/api/")) {
      passOn(service, request, answer);
      return;
    }
    if (pathname === REPORTS) {
      request.on("data", (part: Buffer) => violations.push(part.toString()));
      request.on("end", () => answer.writeHead(204).end());
      return;
    }
    let file = fileOf(pathname);
    if (existsSync(file) && statSync(file).isDirectory()) file = join(file, "index.html");
    if (pathname === "/favicon.ico") answer.writeHead(204).end();
    else if (!existsSync(file)) answer.writeHead(404).end();
    else answer.writeHead(200, { ...security, "content-type": TYPES[extname(file)] ?? "application/octet-stream" }).end(readFileSync(file));
  });
  server.on("upgrade", ({ url, rawHeaders }, socket) => {
    const { hostname, port } = new URL(service ?? "http://localhost");
    const lines = rawHeaders.map((text, k) => (k % 2 === 0 ? `${text}: ` : `${text}\r\n`));
    const passed = connect(Number(port), hostname, () => {
      passed.write(`GET ${url} HTTP/1.1\r\n${lines.join("")}\r\n`);
      passed.pipe(socket).pipe(passed);
    });
    for (const end of [passed, socket]) end.on("error", () => [passed, socket].forEach((one) => one.destroy()));
  });
  await new Promise<void>((done) => server.listen(0, "127.0.0.1", done));
  return { base: `http://127.0.0.1:${(server.address() as AddressInfo).port}`, violations, close: () => {
      server.closeAllConnections();
      server.close();
    },
  };
}

const inRepository = createRequire(join(REPOSITORY, "package.json"));
/** Some bundlers are modules, which this file, once compiled, could not require. */
const bundler = (name: string) => import(pathToFileURL(inRepository.resolve(name)).href);

const PAGE = '<!doctype html><meta charset="utf-8"><style>body{margin:0}</style><script type="module" src="./app.js"></script>';
/** Without a style in the page, which strict policies forbid. */
const STRICT_PAGE = '<!doctype html><meta charset="utf-8"><script type="module" src="./app.js"></script>';

/** A folder with the bundled plain example, for a release of three.js. */
export type Bundle = (three: string, folder: string) => Promise<void>;

const SCENE = join(EXAMPLES, "plain/scene.js");
/** Where a release of three.js is: the package, and its addons. */
const filesOf = (three: string) => ({
  main: join(REPOSITORY, "node_modules", three, "build/three.module.js"),
  addons: join(REPOSITORY, "node_modules", three, "examples/jsm"),
});

/** Bundles an example by Vite. */
export async function bundled(example: string, three: string, folder: string): Promise<void> {
  const { build } = await bundler("vite");
  const { main, addons } = filesOf(three);
  const alias = [
    { find: /^three$/, replacement: main },
    { find: /^three\/addons\//, replacement: `${addons}/` },
  ];
  await build({
    configFile: false,
    logLevel: "error",
    root: join(EXAMPLES, example),
    resolve: { alias },
    build: { outDir: folder, emptyOutDir: true, target: "es2023", chunkSizeWarningLimit: 5000 },
  });
}

export const withVite: Bundle = (three, folder) => bundled("plain", three, folder);

export const withWebpack: Bundle = async (three, folder) => {
  const { default: webpack } = await bundler("webpack");
  const { main, addons } = filesOf(three);
  const options = {
    mode: "development",
    devtool: false,
    entry: { app: SCENE },
    output: { path: folder, filename: "[name].js", publicPath: "auto" },
    resolve: { alias: { three$: main, "three/addons": addons } },
  };
  await new Promise<void>((done, failed) => {
    webpack(options, (fault: Error | null, stats?: { hasErrors(): boolean; toString(): string }) => {
      if (fault || stats?.hasErrors()) failed(fault ?? new Error(String(stats)));
      else done();
    });
  });
  writeFileSync(join(folder, "index.html"), PAGE);
};

async function esbuilt(scene: string, three: string, folder: string): Promise<void> {
  const { build } = await bundler("esbuild");
  const { main, addons } = filesOf(three);
  await build({
    entryPoints: { app: scene, "galewood.worker": "galewood/worker" },
    bundle: true,
    format: "esm",
    logLevel: "error",
    outdir: folder,
    absWorkingDir: EXAMPLES,
    plugins: [
      {
        name: "release",
        setup(builder: { onResolve(options: { filter: RegExp }, find: (from: { path: string }) => { path: string }): void }) {
          builder.onResolve({ filter: /^three$/ }, () => ({ path: main }));
          builder.onResolve({ filter: /^three\/addons\// }, ({ path }) => ({
            path: path.replace("three/addons", addons),
          }));
        },
      },
    ],
  });
}

export const withEsbuild: Bundle = async (three, folder) => {
  await esbuilt(SCENE, three, folder);
  writeFileSync(join(folder, "index.html"), PAGE);
};

/** Bundles a script beside this file, for a page with a strict policy. */
export async function strictPage(script: string, folder: string): Promise<void> {
  await esbuilt(join(__dirname, script), "three", folder);
  writeFileSync(join(folder, "index.html"), STRICT_PAGE);
}
