"""How the page looks, on a screen and on paper, and the little that moves on it."""

from __future__ import annotations

CSS = """\
:root{color-scheme:light}
*{box-sizing:border-box}
body{margin:0 auto;padding:20px 24px 60px;max-width:1160px;background:#fff;color:#1b1f24;
font:14px/1.45 system-ui,"Segoe UI",Roboto,"Helvetica Neue",Arial,"DejaVu Sans",sans-serif}
h1{font-size:24px;margin:0 0 4px}
h2{font-size:17px;margin:30px 0 8px;padding-bottom:3px;border-bottom:1px solid #d0d7de}
p{margin:4px 0}
nav{font-size:13px;margin:10px 0}nav a{display:inline-block;margin-right:14px;color:#0058a3;text-decoration:none}
.verdict{display:inline-block;padding:1px 10px;border-radius:4px;color:#fff;font-weight:600;white-space:nowrap}
.dim,.fact{color:#57606a}.remark{color:#c4231c;font-weight:600}
table{border-collapse:collapse;margin:6px 0;font-size:13px;width:100%}
table.narrow{width:auto}
th{text-align:left;font-weight:600;color:#424a53;border-bottom:1.5px solid #8c959f;vertical-align:bottom}
th,td{padding:3px 12px 3px 0}
td{border-bottom:1px solid #e4e8ec;vertical-align:top}
td.r,th.r{text-align:right;font-variant-numeric:tabular-nums}
td.r,td.s{white-space:nowrap}
td.w{overflow-wrap:anywhere}td.k{min-width:270px}
.hot{color:#c4231c;font-weight:600}
.time,.lanes,.plan{display:block;width:100%;height:auto;margin:6px 0 10px;font-family:inherit}
.cap{margin:-6px 0 2px 62px;font-size:12px;font-weight:600}.figure{margin-bottom:14px}
.two{display:grid;grid-template-columns:1fr 1fr;gap:0 16px}
svg .g{stroke:#e9ecef;fill:none}svg .g.z{stroke:#9aa4ae}
svg .f{fill:none;stroke:#8c959f}
svg .n{font-size:10.5px;fill:#424a53}svg .l{font-size:11px;fill:#1b1f24}
svg .h{font-size:12.5px;font-weight:600;fill:#1b1f24}svg .e{font-weight:400;fill:#57606a}
svg .q{font-size:10.5px;font-weight:700;text-anchor:middle}svg .ph{font-size:10px;fill:#57606a}
svg .m{stroke-width:1;stroke-dasharray:3 2;fill:none}
svg .c{fill:none;stroke-width:15;stroke-linejoin:round}svg .c.t{stroke-width:9}svg .c.d{stroke-dasharray:50 30}
svg .c.r{stroke-width:40;opacity:.55}
svg .o{fill:none;stroke-width:34;stroke-linecap:round}svg .k{fill:none;stroke-width:14}
svg .gap{fill:url(#not-recorded)}.defs{position:absolute}
svg .x{fill:#c4231c;opacity:.07}svg .b{stroke-width:1.6;fill:none}
svg .w{stroke-width:1;stroke-dasharray:1.5 2;fill:none}svg .v{stroke-width:1;stroke-dasharray:7 3;fill:none}
svg .p{fill:#fff;fill-opacity:.7;stroke-width:1.8}
svg .a{font-size:11px;font-weight:600;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}
svg .cross{stroke:#000;stroke-width:.8;pointer-events:none}
svg .read{font-size:11px;paint-order:stroke;stroke:#fff;stroke-width:4px;stroke-linejoin:round;pointer-events:none}
footer{margin-top:30px;color:#57606a;font-size:12px}
@media screen and (max-width:760px){
body{padding:14px 12px 40px}
table{display:block;overflow-x:auto}td.w,td.k{min-width:200px;overflow-wrap:break-word}
.two{grid-template-columns:1fr}
}
@page{size:A4;margin:12mm}
@media print{
body{max-width:none;padding:0;font-size:10pt}
nav,.screen{display:none}
h2{break-after:avoid;margin-top:14px}
.time,.lanes,.plan,.figure,tr,.fact{break-inside:avoid}
table{font-size:8.5pt}td.k{min-width:46mm}
.verdict{print-color-adjust:exact;-webkit-print-color-adjust:exact}
}
"""

GAP = (
    '<svg class="defs" width="0" height="0"><defs><pattern id="not-recorded" width="6" height="6" '
    'patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><rect width="6" height="6" fill="#f4f1ea"/>'
    '<rect width="1.6" height="6" fill="#b9b2a3"/></pattern></defs></svg>'
)
"""What hatches the time of which nothing is recorded; once on a page."""

SCRIPT = """\
(function(){
var L=62,T=36,plots=[].slice.call(document.querySelectorAll('svg.time')),pinned=false;
function make(n,c){var e=document.createElementNS(document.querySelector('svg').namespaceURI,n);
e.setAttribute('class',c);return e}
function curves(s){if(s.read_)return s.read_;
s.read_=[].map.call(s.querySelectorAll('path.c'),function(p){
var xs=[],ys=[];
p.getAttribute('d').split('M').forEach(function(part){
if(!part)return;var n=(part.match(/-?\\d+/g)||[]).map(Number),x=0,y=0;
for(var i=0;n.length>i+1;i+=2){if(i){x+=n[i];y+=n[i+1]}else{x=n[0];y=n[1]}xs.push(x);ys.push(y)}
});
return{label:p.getAttribute('data-label')||'',colour:p.getAttribute('stroke'),xs:xs,ys:ys}});
return s.read_}
function at(c,x){var a=0,b=c.xs.length-1;if(c.xs[0]>x||x>c.xs[b])return null;
while(b-a>1){var m=a+b>>1;if(c.xs[m]>x)b=m;else a=m}
var w=c.xs[b]-c.xs[a];return w>0?c.ys[a]+(c.ys[b]-c.ys[a])*(x-c.xs[a])/w:c.ys[a]}
function show(t){plots.forEach(function(s){
var d=s.dataset,W=s.viewBox.baseVal.width-L-14,h=+d.h;
if(!s.cross_){s.cross_=make('path','cross');s.said_=make('text','read');s.appendChild(s.cross_);s.appendChild(s.said_)}
var x=(t-d.t0)/(d.t1-d.t0)*W,box=s.getBoundingClientRect();
s.cross_.setAttribute('d','M'+(L+x)+' '+T+'v'+h);
if(box.top>innerHeight||0>box.bottom)return;
s.said_.textContent='';
var right=x>W*.5;s.said_.setAttribute('text-anchor',right?'end':'start');
var tx=L+x+(right?-6:6);s.said_.setAttribute('x',tx);s.said_.setAttribute('y',T+11);
var line=make('tspan','');line.textContent=t.toFixed(2)+' s';s.said_.appendChild(line);
curves(s).slice(0,Math.floor(h/13)-1).forEach(function(c){
var y=at(c,x*10);if(y===null)return;
var f=1-y/10/h,a=+d.y0,b=+d.y1,v=d.log?Math.pow(10,Math.log10(a)+f*(Math.log10(b)-Math.log10(a))):a+f*(b-a);
var e=make('tspan','');e.setAttribute('x',tx);e.setAttribute('dy',12);e.setAttribute('fill',c.colour);
e.textContent=said(v,(b-a)/h/10,d.log)+' '+c.label;s.said_.appendChild(e)})})}
function said(v,fine,log){var n=Math.max(0,Math.ceil(-Math.log10(fine)));
return log||n>6?v.toPrecision(3):(Math.abs(v)>fine?v:0).toFixed(n)}
function time(s,e){var b=s.getBoundingClientRect(),k=s.viewBox.baseVal.width,d=s.dataset;
var f=((e.clientX-b.left)/b.width*k-L)/(k-L-14);
return +d.t0+Math.min(1,Math.max(0,f))*(d.t1-d.t0)}
plots.forEach(function(s){
s.addEventListener('mousemove',function(e){if(!pinned)show(time(s,e))});
s.addEventListener('click',function(e){pinned=!pinned;show(time(s,e))})});
})();
"""
"""Without it the page says the same. No less-than sign and no ampersand: the page is XML as well."""
