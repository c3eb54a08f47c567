// How numbers become grey, as those of the quick looks do, or colours, as those of the maps of coverage do.

function colour(map, grey) {
  if (map === "grey") return [grey, grey, grey];
  const { viridis } = page, at = grey / 255 * (viridis.length - 1), k = Math.min(Math.floor(at), viridis.length - 2);
  return viridis[k].map((from, c) => Math.round(from + (at - k) * (viridis[k + 1][c] - from)));
}

/** Black, white and the power of a stretch; of numbers that ascend. */
function stretchOf(mode, ordered, own) {
  if (mode === "own" && own) return { ...own, power: 1 };
  if (!ordered.length) return null;
  const at = (share) => ordered[Math.round(share * (ordered.length - 1))], { look } = page, [low, high] = { p2: [0.02, 0.98], all: [0, 1] }[mode] || look.black_white;
  const black = at(low), white = at(high), share = (at(0.5) - black) / (white - black);
  const power = mode === "look" && share < 0.5 ? Math.max(Math.log(0.5) / Math.log(share), look.least_power) : 1;
  return { black, white, power };
}

function grey({ black, white, power }, value) {
  if (!(white > black)) return white > 0 ? 128 : 0;
  const share = Math.min(Math.max((value - black) / (white - black), 0), 1);
  return Math.floor(255 * (power === 1 ? share : share ** power) + 0.5);
}
