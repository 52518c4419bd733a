"use strict";
// What every page needs: unpacking of payloads, the contents list, printing, and the start of charts and players.
async function unpacked(base64) {
  const bytes = Uint8Array.from(atob(base64.trim()), c => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

function followContents() {
  const links = new Map([...document.querySelectorAll(".contents a")].map(a => [a.hash.slice(1), a]));
  const parts = [...links.keys()].map(id => document.getElementById(id)).filter(Boolean);
  const mark = () => {
    let current = parts[0];
    for (const part of parts) if (part.getBoundingClientRect().top < innerHeight * 0.3) current = part;
    for (const [id, link] of links) {
      if (current && id === current.id) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
  };
  addEventListener("scroll", mark, { passive: true });
  mark();
}

// A film that has not begun shows the run's still, which stands in the page already.
function posters() {
  for (const film of document.querySelectorAll(".film video")) {
    const still = film.closest(".part").querySelector(".hero img");
    if (still) film.poster = still.src;
  }
}

addEventListener("beforeprint", () => document.querySelectorAll("details").forEach(d => { d.open = true; }));

addEventListener("DOMContentLoaded", async () => {
  const state = { charts: 0, players: 0, errors: [] };
  followContents();
  posters();
  try {
    for (const element of document.querySelectorAll(".player")) if (await startPlayer(element)) ++state.players;
    if (typeof grouserCharts !== "undefined") state.charts = await grouserCharts.start();
  } catch (error) {
    state.errors.push(String(error));
    console.error(error);
  }
  // Read by the tests of the page.
  window.grouserPage = state;
  document.documentElement.dataset.ready = "yes";
});
