// How numbers become colours: as the quick looks of mmxrt do.

const VIRIDIS = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37]];

function colour(map, grey) {
  if (map === "grey") return [grey, grey, grey];
  const at = grey / 255 * (VIRIDIS.length - 1), k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  return VIRIDIS[k].map((from, c) => Math.round(from + (at - k) * (VIRIDIS[k + 1][c] - from)));
}

const SHARES = { look: [0.005, 0.995], p2: [0.02, 0.98], all: [0, 1] };

/** Black, white and the power of a stretch; of numbers that ascend. */
function stretchOf(mode, ordered, own) {
  if (mode === "own" && own) return { ...own, power: 1 };
  if (!ordered.length) return null;
  const at = (share) => ordered[Math.round(share * (ordered.length - 1))], [low, high] = SHARES[mode] || SHARES.look;
  const black = at(low), white = at(high), share = (at(0.5) - black) / (white - black);
  const power = mode === "look" && share < 0.5 ? Math.max(Math.log(0.5) / Math.log(share), 1 / 3) : 1;
  return { black, white, power };
}

function grey({ black, white, power }, value) {
  if (!(white > black)) return white > 0 ? 128 : 0;
  const share = Math.min(Math.max((value - black) / (white - black), 0), 1);
  return Math.floor(255 * (power === 1 ? share : share ** power) + 0.5);
}
