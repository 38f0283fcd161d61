//! The style of all pages: black on white, one sheet of A4 where printed.

pub const STYLE: &str = "
:root{color-scheme:light}
@page{size:A4 portrait;margin:8mm}
*{box-sizing:border-box}
body{font:13px/1.35 system-ui,'DejaVu Sans','Liberation Sans',sans-serif;color:#111;background:#fff;margin:0}
main{width:100%;max-width:760px;margin:0 auto;padding:10px}
h1{font-size:19px;margin:0}h2{font-size:13.5px;margin:9px 0 3px;border-bottom:1px solid #888;padding-bottom:1px}
p{margin:2px 0}
svg{display:block;width:100%;height:auto;font-family:system-ui,'DejaVu Sans','Liberation Sans',sans-serif}
.head{display:flex;justify-content:space-between;align-items:flex-start;gap:16px}
.who{font-size:12px;color:#333}
.who b{color:#111}
.score{border:2px solid #111;border-radius:6px;padding:3px 12px;text-align:center;white-space:nowrap}
.score .points{font-size:27px;font-weight:700;line-height:1.1}
.score .verdict{font-weight:700}
.none{border-style:dashed}
.small{font-size:10.5px;color:#333}
.fail{border-left:4px solid #111;padding:1px 8px;margin:4px 0;font-weight:600;font-size:11.5px;background:#eee}
.revised{border:1.5px solid #111;padding:2px 8px;margin:4px 0}
table{border-collapse:collapse;width:100%;font-size:10.5px;line-height:1.25;font-variant-numeric:tabular-nums}
th,td{padding:0 4px;text-align:right;border-bottom:1px solid #ccc;vertical-align:baseline}
th{font-weight:600;border-bottom:1.5px solid #555}
td:first-child,th:first-child{text-align:left;padding-left:0}
td.text,th.text{text-align:left}
td.line{white-space:nowrap}
td.weak{font-weight:700}
.two{display:grid;grid-template-columns:minmax(0,1.5fr) minmax(0,1fr);gap:0 18px;align-items:start}
.bar{display:inline-block;width:34px;height:8px;border:1px solid #333;vertical-align:baseline;background:#fff}
.bar i{display:block;height:100%;background:#444}
ol{margin:2px 0;padding-left:18px;font-size:11.5px}li{margin-bottom:2px}
.sites{font-size:10.5px;color:#333}
details{margin-top:8px;font-size:11.5px}
details p{margin:3px 0}
@media print{main{max-width:none;padding:0;zoom:.88}h2{margin-top:4px}ol{font-size:10.5px}li{margin-bottom:1px}table{line-height:1.08}
.two{grid-template-columns:minmax(0,1.2fr) minmax(0,1fr)}details{display:none}section,tr,svg{break-inside:avoid}}
@media(max-width:620px){.two{grid-template-columns:1fr}}
";
