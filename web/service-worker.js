// Keeps the page for use without a network. Each build has a cache of its own; a new one is taken at the next visit.

const PREFIX = `motionscope ${registration.scope} `;
const CACHE = PREFIX + "@hash@";
const FILES = @files@;

addEventListener("install", (event) => {
  skipWaiting();
  event.waitUntil(keep());
});

async function keep() {
  const cache = await caches.open(CACHE);
  await cache.addAll([new Request("./", { cache: "no-cache" }), ...FILES]);
}

// An open page has loaded everything already, so the caches of older builds can go.
addEventListener("activate", (event) => event.waitUntil(forgetOlder()));

async function forgetOlder() {
  const names = await caches.keys();
  const older = names.filter((name) => name.startsWith(PREFIX) && name !== CACHE);
  await Promise.all(older.map((name) => caches.delete(name)));
}

addEventListener("fetch", (event) => {
  if (event.request.method === "GET") event.respondWith(answer(event.request));
});

async function answer(request) {
  const cache = await caches.open(CACHE);
  const isPage = request.mode === "navigate" && request.url.split(/[?#]/)[0].replace(/index\.html$/, "") === registration.scope;
  return (await cache.match(isPage ? "./" : request)) ?? fetch(request);
}
