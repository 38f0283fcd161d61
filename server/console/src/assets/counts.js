// Counts of a chart, and a stage by the 2017 classification of periodontal diseases.

/** Attachment loss between teeth that counts as a sign of periodontitis, mm. Less is within the error of a reading. */
const LOSS_MM = 2;

function sites(chart, value) {
  return chart.teeth.flatMap((tooth) => ["buccal", "lingual"].flatMap((side) => [0, 1, 2].map((k) => value(tooth, side, k))));
}

const loss = (tooth, side, k) => tooth.depth_mm[side][k] + tooth.recession_mm[side][k];

function share(part, whole) {
  return whole === 0 ? 0 : (100 * part) / whole;
}

/** Pairs of a title and a value in words. */
export function counts(chart) {
  const depths = sites(chart, (tooth, side, k) => tooth.depth_mm[side][k]);
  const bleeding = sites(chart, (tooth, side, k) => tooth.bleeding[side][k]).filter(Boolean).length;
  const losses = sites(chart, loss);
  const many = (list, least) => list.filter((mm) => mm >= least).length;
  const mean = (list) => (list.length === 0 ? 0 : list.reduce((sum, mm) => sum + mm, 0) / list.length);
  const furcated = chart.teeth.filter((tooth) => tooth.furcation.some((degree) => degree > 0)).length;
  const mobile = chart.teeth.filter((tooth) => tooth.mobility > 0).length;
  return [
    ["Teeth present", `${chart.teeth.length}`],
    ["Mean probing depth", `${mean(depths).toFixed(1)} mm`],
    ["Sites of 4 mm or more", `${many(depths, 4)} of ${depths.length}`],
    ["Sites of 6 mm or more", `${many(depths, 6)}`],
    ["Bleeding on probing", `${share(bleeding, depths.length).toFixed(0)} %`],
    ["Mean attachment loss", `${mean(losses).toFixed(1)} mm`],
    ["Furcations, mobile teeth", `${furcated}, ${mobile}`],
  ];
}

/** Whether two of the teeth are not next to each other in the jaw. */
function areApart(teeth) {
  const round = (fdi) => (fdi >= 40 ? 40 - fdi : fdi - 31);
  return teeth.some((a) => teeth.some((b) => Math.abs(round(a) - round(b)) > 1));
}

/** Suggestion from depths, bleeding and attachment loss between teeth. */
export function diagnosis(chart) {
  const worst = (tooth) => Math.max(...["buccal", "lingual"].flatMap((side) => [loss(tooth, side, 0), loss(tooth, side, 2)]));
  const reached = chart.teeth.filter((tooth) => worst(tooth) >= LOSS_MM);
  const depths = sites(chart, (tooth, side, k) => tooth.depth_mm[side][k]);
  const bleeding = share(sites(chart, (tooth, side, k) => tooth.bleeding[side][k]).filter(Boolean).length, depths.length);
  if (areApart(reached.map((tooth) => tooth.fdi))) {
    const most = Math.max(...reached.map(worst));
    const stage = most < 3 ? "I" : most < 5 ? "II" : "III or IV";
    const extent = share(reached.length, chart.teeth.length) < 30 ? "localised" : "generalised";
    return `periodontitis, stage ${stage}, ${extent}; a grade needs the history`;
  }
  if (bleeding < 10) {
    return Math.max(0, ...depths) <= 3 ? "periodontal health" : "no periodontitis; some sites are deeper than 3 mm";
  }
  return `gingivitis, ${bleeding <= 30 ? "localised" : "generalised"}`;
}
