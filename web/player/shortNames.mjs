/**
 * Plugin: gives private members of classes short names, which minifiers cannot. TypeScript allows their use within the class
 * only, so each file is looked at by itself. A name is kept where anything but `this` has a property of
 * that name, or a string contains it.
 */
import { RolldownMagicString } from "rolldown";
import { parseSync } from "rolldown/utils";

const LETTERS = "abcdefghijklmnopqrstuvwxyz";
const short = new Map();

function shortOf(name) {
  const k = short.get(name) ?? short.size;
  short.set(name, k);
  return `$${LETTERS[k % 26]}${k < 26 ? "" : Math.floor(k / 26)}`;
}

/** Visits every node with its ancestors. */
function walk(node, visit, parents = []) {
  if (!node || typeof node !== "object") return;
  const typed = typeof node.type === "string";
  if (typed) visit(node, parents);
  for (const child of Object.values(node)) walk(child, visit, typed ? [...parents, node] : parents);
}

const MEMBERS = new Set(["PropertyDefinition", "MethodDefinition", "AccessorProperty"]);
const nameOf = ({ computed, key }) => (!computed && key?.type === "Identifier" ? key.name : null);
const parameterOf = ({ parameter }) => (parameter.type === "AssignmentPattern" ? parameter.left : parameter);
const classOf = (parents) => parents.findLast(({ type }) => /^Class(Declaration|Expression)$/.test(type));

/** Properties that a file declares, those that it uses of `this`, and the names of those of anything else. */
function propertiesOf(program) {
  const declared = [];
  const used = [];
  const foreign = new Set();
  walk(program, (node, parents) => {
    const owner = classOf(parents);
    const hidden = node.accessibility === "private";
    if (MEMBERS.has(node.type)) declared.push({ name: nameOf(node), node, owner, hidden });
    else if (node.type === "Literal")
      foreign.add(node.value); // this["name"]
    else if (node.type === "TSParameterProperty")
      declared.push({ name: parameterOf(node).name, node, owner, hidden, parents });
    else if (node.type === "MemberExpression" && !node.computed) {
      if (node.object.type === "ThisExpression")
        used.push({ name: node.property.name, node: node.property, owner });
      else foreign.add(node.property.name);
    } else if (node.type === "ObjectPattern") {
      const declarator = parents.at(-1);
      const own = declarator.type === "VariableDeclarator" && declarator.init?.type === "ThisExpression";
      for (const property of node.properties) {
        if (own) used.push({ name: nameOf(property), node: property, owner });
        else foreign.add(nameOf(property));
      }
    }
  });
  return { declared, used, foreign };
}

/** The private names of a file that nothing else in it shares. */
function hiddenNames({ declared, used, foreign }) {
  const names = new Set(declared.filter(({ hidden }) => hidden).map(({ name }) => name));
  for (const { name, hidden } of declared) if (!hidden || foreign.has(name)) names.delete(name);
  const known = new Set(declared.map(({ name, owner }) => `${name} ${owner.start}`));
  for (const { name, owner } of used) if (!known.has(`${name} ${owner?.start}`)) names.delete(name);
  names.delete("constructor");
  return names;
}

/** `constructor(private x)` becomes `constructor(x) { this.x = x; }`. */
function parameterEdits({ name, node, parents }) {
  const { body } = parents.findLast(({ type }) => type === "FunctionExpression");
  const [first] = body.body;
  const at = first?.expression?.callee?.type === "Super" ? first.end : body.start + 1;
  return [
    [node.start, parameterOf(node).start, ""],
    [at, at, `\nthis.${shortOf(name)} = ${name};`],
  ];
}

function useEdit({ name, node }) {
  if (node.type !== "Property") return [node.start, node.end, shortOf(name)];
  return [node.key.start, node.key.end, node.shorthand ? `${shortOf(name)}: ${name}` : shortOf(name)];
}

/** The code with `instead` in the place of from..to of each edit, and the map that leads back. */
export function edited(code, edits) {
  const text = new RolldownMagicString(code);
  for (const [from, to, instead] of edits) {
    if (from === to) text.appendLeft(from, instead);
    else if (instead === "") text.remove(from, to);
    else text.overwrite(from, to, instead);
  }
  return { code: text.toString(), map: text.generateMap({ hires: true }).toString() };
}

function shorten(code, id) {
  const found = propertiesOf(parseSync(id, code).program);
  const names = hiddenNames(found);
  const ours = ({ name }) => names.has(name);
  const edits = found.declared
    .filter(ours)
    .flatMap((one) =>
      one.node.type === "TSParameterProperty"
        ? parameterEdits(one)
        : [[one.node.key.start, one.node.key.end, shortOf(one.name)]],
    )
    .concat(found.used.filter(ours).map(useEdit));
  return edited(code, edits);
}

export const shortNames = {
  name: "short-names",
  transform: { filter: { id: /\.ts$/, code: /private/ }, handler: shorten },
};
