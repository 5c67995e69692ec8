#include "bench/page/page.h"

namespace delassus::bench {

const char* page_style() {
  return R"css(
:root{color-scheme:light dark;--ink:#1b1f24;--soft:#57606a;--line:#d0d7de;--paper:#fff;--card:#f6f8fa;--good:#1a7f37;--bad:#c11528;--mark:#0b62b8;--shade:#0003;
--t0:#f3f6f9;--t1:#dde5ec;--t2:#c9d4de;--edge:#4a5868;--contact:#c2410c;--loop:#7c3aed}
@media (prefers-color-scheme:dark){:root{--ink:#e6e9ec;--soft:#9aa4ae;--line:#3a424b;--paper:#14181c;--card:#1c2127;--good:#4cc26a;--bad:#ff7b72;--mark:#6cb2ff;--shade:#fff3;
--t0:#55616d;--t1:#404a54;--t2:#333c45;--edge:#9fb0c0;--contact:#ff9a5c;--loop:#b794ff}}
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0 auto;max-width:1240px;padding:1.2rem 1rem 3rem;font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;color:var(--ink);background:var(--paper)}
h1{font-size:1.7rem;line-height:1.2;margin:.2rem 0 .4rem}
h2{font-size:1.25rem;margin:2.4rem 0 .5rem;padding-bottom:.2rem;border-bottom:1px solid var(--line)}
h3{font-size:1.02rem;margin:0 0 .2rem}
p{margin:.4rem 0;max-width:75ch}
a{color:var(--mark)}
code,.math{font-family:ui-monospace,"DejaVu Sans Mono",Menlo,Consolas,monospace;font-size:.9em}
pre{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:6px;padding:.6rem .8rem;font-size:.86rem}
.soft{color:var(--soft)}
.small{font-size:.86rem}
nav{font-size:.92rem;margin:.6rem 0}
nav a{margin-right:1rem;white-space:nowrap}
.facts{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:.6rem;margin:1rem 0}
.facts div{background:var(--card);border:1px solid var(--line);border-radius:6px;padding:.5rem .7rem}
.facts b{display:block;font-size:1.35rem;line-height:1.25;font-weight:650}
.facts div>span{color:var(--soft);font-size:.84rem}
.wide{overflow-x:auto;margin:.5rem 0 1rem;max-width:100%;background:linear-gradient(90deg,var(--paper) 40%,transparent),linear-gradient(270deg,var(--paper) 40%,transparent) 100% 0,linear-gradient(90deg,var(--shade),transparent),linear-gradient(270deg,var(--shade),transparent) 100% 0;background-repeat:no-repeat;background-size:44px 100%,44px 100%,16px 100%,16px 100%;background-attachment:local,local,scroll,scroll}
table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums}
th,td{padding:.2rem .42rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{font-weight:600;vertical-align:bottom}
th small,td small{font-weight:400;color:var(--soft)}
thead th{border-bottom:2px solid var(--line)}
th:first-child,td:first-child{text-align:left}
td.text,th.text{text-align:left;white-space:normal;min-width:7.5rem;vertical-align:top}
th:first-child,td:first-child{position:sticky;left:0;background:var(--paper)}
.tables table{font-size:.8rem}.tables th,.tables td{padding:.18rem .34rem}
.bars{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.1rem .6rem;font-size:.8rem;align-items:center;margin:.3rem 0;max-width:640px}
.bars>div{display:flex;align-items:center;gap:.4rem;white-space:nowrap}
.bars i{display:block;height:.7rem;flex:none}
.k0{background:#8c959f}.k1{background:#0072b2}.k2{background:#e69f00}.k3{background:#cc79a7}
.bars-key{font-size:.8rem;color:var(--soft)}.bars-key i{display:inline-block;width:.8rem;height:.7rem;margin:0 .25rem 0 .7rem}
.matrix th{white-space:normal;min-width:3.4rem}
.matrix th:first-child{white-space:nowrap}
.tables .upright th,.tables .upright td{padding:.18rem .2rem}
.upright thead th+th{writing-mode:vertical-rl;transform:rotate(180deg);min-width:0;white-space:nowrap;text-align:left;vertical-align:middle}
caption{text-align:left;font-weight:600;padding:.2rem .55rem .3rem 0;font-size:.92rem}
.good{color:var(--good)}
.bad{color:var(--bad);font-weight:700}
.fast{font-weight:700}
.grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,400px),1fr));gap:1rem 1.6rem}
figure{margin:0;min-width:0}
figcaption{font-size:.86rem;color:var(--soft)}
svg{display:block;width:100%;height:auto}
svg.plot text,svg.plot tspan{font-family:inherit}
.scene{border-top:1px solid var(--line);padding:1rem 0 .4rem;display:grid;grid-template-columns:minmax(0,230px) minmax(0,1fr);gap:.4rem 1.2rem;align-items:start}
.scene .wide{margin-bottom:.2rem}.scene table{font-size:.8rem}.scene th,.scene td{padding:.18rem .36rem}
@media (max-width:1160px){.scene figure{max-width:420px}.scene{grid-template-columns:minmax(0,1fr)}}
.picture path{fill:none;stroke:var(--edge);stroke-width:.8;stroke-linejoin:round;vector-effect:non-scaling-stroke}
.picture .t0{fill:var(--t0)}.picture .t1{fill:var(--t1)}.picture .t2{fill:var(--t2)}
.picture .ground{stroke:var(--line);stroke-width:.7}
.picture .link{stroke:var(--ink);stroke-width:1.1;opacity:.75}
.picture .joint{fill:var(--paper);stroke:var(--ink);stroke-width:1.2}
.picture .friction{stroke:var(--ink);stroke-width:.9}
.picture .contact{fill:var(--contact);stroke:var(--paper);stroke-width:.5}
.picture .loop{stroke:var(--loop);stroke-width:1.4;fill:var(--paper);stroke-dasharray:none}
.picture path.loop[d*="L"]{stroke-dasharray:4 2.5}
.picture .scale{stroke:var(--soft);stroke-width:1}
.picture text.scale{fill:var(--soft);font-size:12px;stroke:none}
.legend{list-style:none;display:flex;flex-wrap:wrap;gap:.2rem 1.4rem;padding:0;margin:.4rem 0 1rem;font-size:.88rem}
.legend li{display:flex;align-items:center;gap:.4rem}
svg.key{width:2rem;flex:none}
details{margin:.5rem 0}
summary{cursor:pointer;color:var(--mark)}
@media (max-width:600px){body{padding:.8rem .7rem 2rem;font-size:15px}h1{font-size:1.4rem}.facts{grid-template-columns:repeat(2,1fr)}th,td{padding:.2rem .4rem}}
@media print{:root{color-scheme:light;--ink:#000;--soft:#333;--line:#999;--paper:#fff;--card:#fff;--good:#000;--bad:#000;--mark:#000;--t0:#fff;--t1:#e8e8e8;--t2:#d5d5d5;--edge:#444;--contact:#000;--loop:#000}
body{max-width:none;font-size:10pt;padding:0}nav{display:none}.scene,figure,tr{break-inside:avoid}.wide{overflow:visible}table{font-size:7.5pt}th,td{padding:.1rem .3rem}}
)css";
}

}  // namespace delassus::bench
