/** The snippet that shows this forest in another page. Pure. */

/** Escapes a text for an HTML attribute. */
const attribute = (text: string) => text.replaceAll("&", "&amp;").replaceAll('"', "&quot;");

/** An iframe with the page of a link, without its controls. */
export function embedCode(link: string): string {
  const url = new URL(link);
  url.searchParams.set("embed", "1");
  return (
    `<iframe src="${attribute(url.href)}" width="960" height="540" style="border:0" ` +
    `title="Galewood: a forest in the wind" allow="fullscreen" loading="lazy"></iframe>`
  );
}
