// Generated from clients/web by `npm run page`; do not edit. Licences of the libraries in it: THIRD-PARTY.txt.
"use strict";(()=>{var Ii=[0,0,0],tv=[0,0,0,1],yi=(i,e)=>[i[0]+e[0],i[1]+e[1],i[2]+e[2]],Wi=(i,e)=>[i[0]-e[0],i[1]-e[1],i[2]-e[2]],Ut=(i,e)=>[i[0]*e,i[1]*e,i[2]*e],io=(i,e)=>i[0]*e[0]+i[1]*e[1]+i[2]*e[2],Ju=(i,e)=>[i[1]*e[2]-i[2]*e[1],i[2]*e[0]-i[0]*e[2],i[0]*e[1]-i[1]*e[0]],kt=i=>Math.hypot(i[0],i[1],i[2]),Il=i=>i.every(Number.isFinite);function qp(i,e){return[i[3]*e[0]+i[0]*e[3]+i[1]*e[2]-i[2]*e[1],i[3]*e[1]-i[0]*e[2]+i[1]*e[3]+i[2]*e[0],i[3]*e[2]+i[0]*e[1]-i[1]*e[0]+i[2]*e[3],i[3]*e[3]-i[0]*e[0]-i[1]*e[1]-i[2]*e[2]]}function Ll(i){let e=Math.hypot(...i);return e>1e-9?[i[0]/e,i[1]/e,i[2]/e,i[3]/e]:tv}function $p(i,e){let t=Math.sin(e/2)/(kt(i)||1);return Ll([i[0]*t,i[1]*t,i[2]*t,Math.cos(e/2)])}var ci=class{low=[1/0,1/0,1/0];high=[-1/0,-1/0,-1/0];take(e){for(let t=0;t+2<e.length;t+=3)for(let n=0;n<3;n++){let s=e[t+n];s<this.low[n]&&(this.low[n]=s),s>this.high[n]&&(this.high[n]=s)}return this}get empty(){return!this.low.every((e,t)=>e<=this.high[t])}get middle(){return this.empty?Ii:Ut(yi(this.low,this.high),.5)}get size(){return this.empty?.1:kt(Wi(this.high,this.low))||.1}};var nv=["displacement","indentation","curvature","stiffness","body","none"],iv=["system","light","dark"],Yp=(i,e)=>i[(i.indexOf(e)+1)%i.length];function sv(i){let e=i.target;return document.querySelector("dialog[open]")!==null?i.key!=="?":e===null||e.closest?.("dialog:not([open])")?!1:e.matches("select, textarea, input:not([type=range]):not([type=checkbox])")?!0:e.matches("input[type=range]")?/^(Arrow|Page|Home|End)/.test(i.key):e.matches("button, input[type=checkbox]")&&(i.key===" "||i.key==="Enter")}function Zp(i){addEventListener("keydown",e=>{e.defaultPrevented||sv(e)||e.ctrlKey||e.metaKey||rv(i,e)&&e.preventDefault()})}function rv(i,e){return ov(i,e)?!0:(i.playback!==null?lv(i,e):av(i,e))||cv(i,e)}function ov(i,e){let{hand:t,stage:n}=i;if(t===null||n===null||t.state!=="holding")return!1;let{right:s,up:r,away:o}=n.axes(),a=(e.shiftKey?.004:.015)*i.size;switch(e.key){case"ArrowLeft":return t.move(Ut(s,-a)),!0;case"ArrowRight":return t.move(Ut(s,a)),!0;case"ArrowUp":return t.move(Ut(r,a)),!0;case"ArrowDown":return t.move(Ut(r,-a)),!0;case"PageUp":return t.move(Ut(o,a)),!0;case"PageDown":return t.move(Ut(o,-a)),!0;case"g":case"G":return t.grip=!t.grip,!0;case"Escape":return t.letGo(),!0;default:return!1}}function av(i,{key:e}){let t=i.liveDeck;if(t===null)return!1;switch(e){case" ":return t.pause(),!0;case".":return t.step(),!0;case"r":case"R":return t.record(),!0;case"k":case"K":return t.snapshot(),!0;case"Backspace":return t.reset(),!0;case"t":case"T":return i.takeOrLetGo(),!0;default:return!1}}function lv(i,e){let{playback:t,playbackDeck:n}=i;if(t===null||n===null)return!1;let s=Math.max(1,Math.round(.1/t.recording.dt));switch(e.key){case" ":return t.toggle(),!0;case",":return n.stepBy(-1),!0;case".":return n.stepBy(1),!0;case"<":return n.stepBy(-s),!0;case">":return n.stepBy(s),!0;case"Home":return n.go(t.first),!0;case"End":return n.go(t.last),!0;case"l":case"L":return n.toggleLoop(),!0;case"+":case"-":return e.altKey?(n.faster(e.key==="+"?1:-1),!0):!1;default:return!1}}function cv(i,{key:e}){let{settings:t,stage:n}=i;switch(e){case"f":case"F":return i.fit(),!0;case"0":return i.lookFrom("iso"),!0;case"1":return i.lookFrom("front"),!0;case"2":return i.lookFrom("side"),!0;case"3":return i.lookFrom("top"),!0;case"+":case"=":return n?.zoom(.85),!0;case"-":return n?.zoom(1/.85),!0;case"ArrowLeft":return n?.orbit(-.12,0),!0;case"ArrowRight":return n?.orbit(.12,0),!0;case"ArrowUp":return n?.orbit(0,.1),!0;case"ArrowDown":return n?.orbit(0,-.1),!0;case"[":return i.chooseNext(-1),!0;case"]":return i.chooseNext(1),!0;case"v":case"V":return i.look.toggle(),!0;case"n":case"N":return t.set(s=>s.layers.net=!s.layers.net),!0;case"c":case"C":return t.set(s=>s.colourBy=Yp(nv,s.colourBy)),!0;case"d":case"D":return t.set(s=>s.theme=Yp(iv,s.theme)),!0;case"u":case"U":return t.set(s=>s.sound=!s.sound),!0;case"p":case"P":return i.savePicture(),!0;case"b":case"B":return t.set(s=>s.layers.lattice=!s.layers.lattice),!0;case"o":case"O":return i.saveNets(),!0;case"e":case"E":return i.saveStep(),!0;case"?":return i.showHelp(),!0;default:return!1}}var ca=class{constructor(e){this.bytes=e}bytes;get size(){return this.bytes.length}read(e,t){return Promise.resolve(this.bytes.subarray(e,e+t))}},Nl=class{constructor(e){this.blob=e}blob;get size(){return this.blob.size}async read(e,t){return new Uint8Array(await this.blob.slice(e,e+t).arrayBuffer())}},ju=class{constructor(e,t){this.url=e;this.size=t}url;size;async read(e,t){let n=Math.min(e+t,this.size)-1;if(n<e)return new Uint8Array;let s=await fetch(this.url,{headers:{Range:`bytes=${e}-${n}`}});if(s.status!==206)throw new Error(`${this.url}: the server answered ${s.status} to a range request`);return new Uint8Array(await s.arrayBuffer())}};async function Kp(i){let e=await fetch(i,{headers:{Range:"bytes=0-0"}});if(!e.ok)throw new Error(`${i}: the server answered ${e.status}`);let t=/\/(\d+)$/.exec(e.headers.get("Content-Range")??"");return e.status===206&&t!==null?(await e.arrayBuffer(),new ju(i,Number(t[1]))):new ca(new Uint8Array(await e.arrayBuffer()))}var Dl=class{constructor(e,t=1<<20){this.source=e;this.length=t}source;length;at=0;block=new Uint8Array;get size(){return this.source.size}async read(e,t){if(e<this.at||e+t>this.at+this.block.length){if(t>this.length)return this.source.read(e,t);this.block=new Uint8Array(await this.source.read(e,this.length)),this.at=e}return this.block.subarray(e-this.at,e-this.at+t)}};var An=class extends Error{constructor(t,n){super(n);this.fault=t;this.reason=n}fault;reason;name="DecodeError";type="";field="";inside(t){this.field=this.field===""?t:`${t}.${this.field}`}of(t){return this.type=t,this.message=`not a ${t}: ${this.reason}`+(this.field===""?"":` (in ${this.field})`),this}},xn=class extends Error{name="EncodeError"};var Ks=class{constructor(e){this.bytes=e;this.view=new DataView(e.buffer,e.byteOffset,e.byteLength)}bytes;view;at=0;left(){return this.bytes.length-this.at}skip(e){let t=this.at;if(e>this.left()){let n=this.bytes.length;throw new An("truncated",`${n} bytes end where ${e} more were to begin at ${t}`)}return this.at=t+e,t}byte(){return this.view.getUint8(this.skip(1))}f64(){return this.view.getFloat64(this.skip(8),!0)}flag(){let e=this.byte();if(e>1)throw new An("malformed",`${e} is neither 0 nor 1`);return e===1}varint(e){let t=0n;for(let n=0;n<e;n+=7){let s=this.byte();if(t|=BigInt(s&127)<<BigInt(n),s<128){if(t>>BigInt(e)!==0n)break;return t}}throw new An("malformed",`a number has more than ${e} bits`)}count(e){let t=this.varint(64);if(t*BigInt(e)>BigInt(this.left()))throw new An("truncated",`${t} items cannot be in the ${this.left()} bytes left`);return Number(t)}},Js=class{buffer=new Uint8Array(256);view=new DataView(this.buffer.buffer);length=0;room(e){let t=this.length;if(this.length+=e,this.length>this.buffer.length){let n=new Uint8Array(Math.max(2*this.buffer.length,this.length));n.set(this.buffer),this.buffer=n,this.view=new DataView(n.buffer)}return t}byte(e){let t=this.room(1);this.view.setUint8(t,e)}f64(e){if(typeof e!="number")throw new xn(`${Xi(e)} is not a number`);let t=this.room(8);this.view.setFloat64(t,e,!0)}raw(e){let t=this.room(e.length);this.buffer.set(e,t)}varint(e){let t=BigInt(e);for(;t>=0x80n;)this.byte(Number(t&0x7fn)|128),t>>=7n;this.byte(Number(t))}finish(){return this.buffer.slice(0,this.length)}};function Xi(i){return String(i).slice(0,80)}function Qu(i){return{minBytes:1,read:e=>i===8?e.byte():Number(e.varint(i)),write(e,t){if(!Number.isInteger(t)||t<0||t>=2**i)throw new xn(`${Xi(t)} is not a whole number of ${i} bits`);i===8?e.byte(t):e.varint(t)},json:e=>e}}var Es=Qu(8),so=Qu(16),ha=Qu(32),$e={minBytes:1,read:i=>i.varint(64),write(i,e){if(typeof e!="bigint"||e<0n||e>>64n!==0n)throw new xn(`${Xi(e)} is not a bigint of 64 bits`);i.varint(e)},json:i=>i<=BigInt(Number.MAX_SAFE_INTEGER)?Number(i):String(i)},ed=i=>Number.isFinite(i)?i:null,Rt={minBytes:8,read:i=>i.f64(),write:(i,e)=>i.f64(e),json:ed},td={minBytes:1,read:i=>i.flag(),write(i,e){if(typeof e!="boolean")throw new xn(`${Xi(e)} is not a boolean`);i.byte(e?1:0)},json:i=>i},hv=new TextDecoder("utf-8",{fatal:!0,ignoreBOM:!0}),mt={minBytes:1,read(i){let e=i.count(1),t=i.skip(e);try{return hv.decode(i.bytes.subarray(t,t+e))}catch{throw new An("malformed",`text of ${e} bytes is not UTF-8`)}},write(i,e){if(typeof e!="string"||/\p{Surrogate}/u.test(e))throw new xn(`${Xi(e)} is not text`);let t=new TextEncoder().encode(e);i.varint(t.length),i.raw(t)},json:i=>i};function Jp(i){return{minBytes:i,read(e){let t=e.skip(i);return e.bytes.slice(t,t+i)},write(e,t){if(!(t instanceof Uint8Array)||t.length!==i)throw new xn(`not ${i} bytes`);e.raw(t)},json:e=>[...e]}}function xr(i,e){return{minBytes:i.minBytes*e,read:t=>Array.from({length:e},()=>i.read(t)),write(t,n){if(!Array.isArray(n)||n.length!==e)throw new xn(`${Xi(n)} has not ${e} items`);for(let s of n)i.write(t,s)},json:t=>t.map(n=>i.json(n))}}function ua(i){return{minBytes:1,read(e){let t=e.count(i.minBytes);return Array.from({length:t},()=>i.read(e))},write(e,t){if(!Array.isArray(t))throw new xn(`${Xi(t)} is not an array`);e.varint(t.length);for(let n of t)i.write(e,n)},json:e=>e.map(t=>i.json(t))}}function jp(i,e){return{minBytes:1,read(t){let n=new Float64Array(i*t.count(8*i));for(let s=0;s<n.length;s++)n[s]=t.f64();return n},write(t,n){if(!(n instanceof Float64Array)||n.length%i!==0)throw new xn(`${Xi(n)} is not a Float64Array of ${i} numbers an item`);t.varint(n.length/i);for(let s of n)t.f64(s)},json(t){let n=[];for(let s=0;s<t.length;s+=i)n.push(e(t.subarray(s,s+i)));return n}}}var Fl=jp(1,([i])=>ed(i??NaN)),Ul=jp(3,i=>[...i].map(ed));function nd(i){return{minBytes:1,read:e=>e.flag()?i.read(e):null,write(e,t){e.byte(t===null?0:1),t!==null&&i.write(e,t)},json:e=>e===null?null:i.json(e)}}function Bt(i){let e=Object.entries(i);return{minBytes:e.reduce((t,[,n])=>t+n.minBytes,0),read(t){let n={};for(let[s,r]of e)try{n[s]=r.read(t)}catch(o){throw o instanceof An&&o.inside(s),o}return n},write(t,n){if(typeof n!="object"||n===null)throw new xn(`${Xi(n)} is not an object`);for(let[s,r]of e)try{r.write(t,n[s])}catch(o){throw o instanceof xn?new xn(`${s}: ${o.message}`):o}},json(t){if(e.length===0)return;let n=t;return Object.fromEntries(e.map(([s,r])=>[s,r.json(n[s])]))}}}function Qp(i,e){let t=e<BigInt(i.length)?i[Number(e)]:void 0;if(t===void 0)throw new An("unknown-case",`no case has number ${e}, the last is ${i.length-1}`);return t}function id(...i){return{minBytes:1,read:e=>Qp(i,e.varint(32)),write(e,t){if(!i.includes(t))throw new xn(`${Xi(t)} is none of ${i.join(", ")}`);e.varint(i.indexOf(t))},json:e=>e}}function em(i){let e=Object.keys(i),t=n=>{let s=e.includes(n)?i[n]:void 0;if(s===void 0)throw new xn(`${Xi(n)} is no case of this choice`);return s};return{minBytes:1,read(n){let s=Qp(e,n.varint(32));return{type:s,...t(s).read(n)}},write(n,s){let r=s?.type,o=t(r);n.varint(e.indexOf(r)),o.write(n,s)},json(n){let s=n.type,r=t(s).json(n);return r===void 0?s:{[s]:r}}}}var tm=em({Reset:Bt({}),Paused:Bt({}),Resumed:Bt({}),ToolJoined:Bt({tool:mt}),ToolLost:Bt({tool:mt}),PoseRefused:Bt({tool:mt,reason:mt}),Fault:Bt({reason:mt}),RecordStarted:Bt({path:mt}),RecordStopped:Bt({path:mt}),Stopping:Bt({}),Overrun:Bt({stage:mt,count:$e,worst_ns:$e}),QualityChanged:Bt({level:Es,reason:mt}),DeviceTold:Bt({tool:mt,name:mt}),RecordFailed:Bt({path:mt,reason:mt}),SceneChanged:Bt({what:mt}),ForceWithheld:Bt({tool:mt}),ForceDegraded:Bt({tool:mt,reason:mt}),ForceRestored:Bt({tool:mt,ticks:$e})});function qi(i,e,t,n=16<<20){return{type:i,key:e,maxBytes:n,wire:Bt(t)}}function nm(i){return`postcard;${i.type}`}function _i(i,e,t=""){try{if(t!==""&&t!==nm(i))throw new An("wrong-schema",`the encoding's schema is "${t.slice(0,128)}"`);if(e.length>i.maxBytes)throw new An("oversized",`${e.length} bytes are more than any has (${i.maxBytes})`);let n=new Ks(e),s=i.wire.read(n);if(n.left()>0)throw new An("trailing-bytes",`${n.left()} bytes after its end`);return s}catch(n){throw n instanceof An?n.of(i.type):n}}function Ol(i,e){let t=new Js;i.wire.write(t,e);let n=t.finish();if(n.length>i.maxBytes)throw new xn(`${n.length} bytes are more than any ${i.type} has (${i.maxBytes})`);return n}var $n=xr(Rt,3),kl=xr(Rt,4),im=qi("palpate.ToolPose.v1","tool/{tool}/pose",{seq:$e,t_client_ns:$e,position:$n,orientation:kl,linear_velocity:$n,angular_velocity:$n,buttons:ha,flags:ha},134);var en={STALE:1,SATURATED:2,PAUSED:4,REFUSED:8,RAMPING:16,FAULT:32,GRABBING:64,DAMPED:128,WITHHELD:256,DEGRADED:512},sm=qi("palpate.ToolForce.v1","tool/{tool}/force",{tick:$e,pose_seq:$e,t_client_ns:$e,t_server_ns:$e,force:$n,torque:$n,proxy_position:$n,proxy_orientation:kl,depth:Rt,contact_count:so,flags:ha}),rm=qi("palpate.ToolForce.v2","tool/{tool}/force_v2",{tick:$e,pose_seq:$e,t_client_ns:$e,t_server_ns:$e,force:$n,torque:$n,proxy_position:$n,proxy_orientation:kl,depth:Rt,contact_count:so,flags:ha,error_n:Rt,jaw_force:Rt}),om=qi("palpate.ToolContact.v1","tool/{tool}/contact",{tick:$e,pose_seq:$e,t_client_ns:$e,force:$n,torque:$n,energy_j:Rt,dissipated_j:Rt,force_limit:Rt}),rd=qi("palpate.DeviceInfo.v1","tool/{tool}/device",{name:mt,dof_force:Es,dof_torque:Es,workspace:$n,force_max:Rt,force_continuous:Rt,torque_max:Rt,mass:Rt,damping:Rt,coulomb_friction:Rt,encoder_resolution:Rt,rate_hz:Rt,delay_s:Rt,deadband:Rt},180),am=qi("palpate.ControlNet.v1","body/{body}/net",{tick:$e,revision:$e,body:mt,degree_u:Es,degree_v:Es,count_u:so,count_v:so,points:Ul,weights:nd(Fl)}),uv=Bt({tool:mt,body:mt,u:Rt,v:Rt,point:$n,normal:$n,depth:Rt,force:$n}),lm=qi("palpate.ContactSet.v1","contact",{tick:$e,contacts:ua(uv)}),sd=Bt({p50_ns:$e,p99_ns:$e,max_ns:$e}),dv=id("Running","Paused","Stopping"),fv=Bt({tool:mt,received:$e,superseded:$e,wrong_version:$e,malformed:$e,oversized:$e,not_finite:$e,bad_quaternion:$e,duplicated:$e,out_of_order:$e,jumps:$e,stale_ticks:$e,energy_j:Rt,forces_sent:$e,forces_overtaken:$e,forces_lost:$e}),pv=id("Off","Recording","Ring","Failed"),cm=qi("palpate.LoopStatus.v4","status",{tick:$e,state:dv,rate_hz:Rt,late_ticks:$e,skipped_ticks:$e,period:sd,step:sd,tools:ua(fv),recorder:pv,recorder_bytes:$e,recorder_drops:$e,quality_level:Es,followed_tool:mt,shift_s:Rt,wait:sd}),hm=qi("palpate.SimEvent.v1","event",{tick:$e,seq:$e,t_ns:$e,kind:tm}),mv=Bt({id:mt,model:mt,degree:xr(Es,2),periodic:xr(td,2),knots:xr(Fl,2),count:xr(so,2),points:Ul,rest_points:Ul,weights:nd(Fl),revision:$e}),gv=Bt({id:mt,shape:mt,radius:Rt,stiffness:Rt,damping:Rt,force_max:Rt,position:$n,orientation:kl}),Bl=qi("palpate.SceneSnapshot.v1","scene",{tick:$e,scene_hash:Jp(32),scene_name:mt,dt_ns:$e,lockstep:td,bodies:ua(mv),tools:ua(gv)});var yv=50,_v=100,vv=10,um=100,da=class{limit;last=null;before=1;since=0;from=1;constructor(e=!1){this.limit=e?_v:yv}heard(e=performance.now()){let t=this.silence(e),n=t===null?1:this.gain(e);(t===null||t>this.limit)&&(this.since=e,this.from=n),this.before=n,this.last=Math.max(e,this.last??e)}silence(e=performance.now()){return this.last===null?null:Math.max(0,e-this.last)}gain(e=performance.now()){let t=this.silence(e);if(t===null||this.last===null)return 0;let n=Math.min(this.from+(this.last-this.since)/um,1),s=Math.min(t,this.limit),r=Math.min(this.before+s/um,n);return Math.max(0,r-(t-s)/vv)}felt(e,t=performance.now()){let n=this.gain(t);if(n===1)return e;let s=([r,o,a])=>[r*n,o*n,a*n];return{...e,force:s(e.force),torque:s(e.torque),flags:e.flags|en.RAMPING}}};var xv=ArrayBuffer,fn=Uint8Array,zl=Uint16Array,bv=Int16Array;var Vl=Int32Array,od=function(i,e,t){if(fn.prototype.slice)return fn.prototype.slice.call(i,e,t);(e==null||e<0)&&(e=0),(t==null||t>i.length)&&(t=i.length);var n=new fn(t-e);return n.set(i.subarray(e,t)),n},pa=function(i,e,t,n){if(fn.prototype.fill)return fn.prototype.fill.call(i,e,t,n);for((t==null||t<0)&&(t=0),(n==null||n>i.length)&&(n=i.length);t<n;++t)i[t]=e;return i},Sv=function(i,e,t,n){if(fn.prototype.copyWithin)return fn.prototype.copyWithin.call(i,e,t,n);for((t==null||t<0)&&(t=0),(n==null||n>i.length)&&(n=i.length);t<n;)i[e++]=i[t++]};var Mv=["invalid zstd data","window size too large (>2046MB)","invalid block type","FSE accuracy too high","match distance too far back","unexpected EOF"],bn=function(i,e,t){var n=new Error(e||Mv[i]);if(n.code=i,Error.captureStackTrace&&Error.captureStackTrace(n,bn),!t)throw n;return n},dm=function(i,e,t){for(var n=0,s=0;n<t;++n)s|=i[e++]<<(n<<3);return s},wv=function(i,e){return(i[e]|i[e+1]<<8|i[e+2]<<16|i[e+3]<<24)>>>0},Tv=function(i,e){var t=i[0]|i[1]<<8|i[2]<<16;if(t==3126568&&i[3]==253){var n=i[4],s=n>>5&1,r=n>>2&1,o=n&3,a=n>>6;n&8&&bn(0);var l=6-s,c=o==3?4:o,h=dm(i,l,c);l+=c;var d=a?1<<a:s,u=dm(i,l,d)+(a==1&&256),f=u;if(!s){var g=1<<10+(i[5]>>3);f=g+(g>>3)*(i[5]&7)}f>2145386496&&bn(1);var y=new fn((e==1?u||f:e?0:f)+12);return y[0]=1,y[4]=4,y[8]=8,{b:l+d,y:0,l:0,d:h,w:e&&e!=1?e:y.subarray(12),e:f,o:new Vl(y.buffer,0,3),u,c:r,m:Math.min(131072,f)}}else if((t>>4|i[3]<<20)==25481893)return wv(i,4)+8;bn(0)},br=function(i){for(var e=0;1<<e<=i;++e);return e-1},ma=function(i,e,t){var n=(e<<3)+4,s=(i[e]&15)+5;s>t&&bn(3);for(var r=1<<s,o=r,a=-1,l=-1,c=-1,h=r,d=new xv(512+(r<<2)),u=new bv(d,0,256),f=new zl(d,0,256),g=new zl(d,512,r),y=512+(r<<1),p=new fn(d,y,r),m=new fn(d,y+r);a<255&&o>0;){var x=br(o+1),A=n>>3,S=(1<<x+1)-1,R=(i[A]|i[A+1]<<8|i[A+2]<<16)>>(n&7)&S,M=(1<<x)-1,_=S-o-1,E=R&M;if(E<_?(n+=x,R=E):(n+=x+1,R>M&&(R-=_)),u[++a]=--R,R==-1?(o+=R,p[--h]=a):o-=R,!R)do{var k=n>>3;l=(i[k]|i[k+1]<<8)>>(n&7)&3,n+=2,a+=l}while(l==3)}(a>255||o)&&bn(0);for(var N=0,L=(r>>1)+(r>>3)+3,B=r-1,V=0;V<=a;++V){var P=u[V];if(P<1){f[V]=-P;continue}for(c=0;c<P;++c){p[N]=V;do N=N+L&B;while(N>=h)}}for(N&&bn(0),c=0;c<r;++c){var F=f[p[c]]++,X=m[c]=s-br(F);g[c]=(F<<X)-r}return[n+7>>3,{b:s,s:p,n:m,t:g}]},Ev=function(i,e){var t=0,n=-1,s=new fn(292),r=i[e],o=s.subarray(0,256),a=s.subarray(256,268),l=new zl(s.buffer,268);if(r<128){var c=ma(i,e+1,6),h=c[0],d=c[1];e+=r;var u=h<<3,f=i[e];f||bn(0);for(var g=0,y=0,p=d.b,m=p,x=(++e<<3)-8+br(f);x-=p,!(x<u);){var A=x>>3;if(g+=(i[A]|i[A+1]<<8)>>(x&7)&(1<<p)-1,o[++n]=d.s[g],x-=m,x<u)break;A=x>>3,y+=(i[A]|i[A+1]<<8)>>(x&7)&(1<<m)-1,o[++n]=d.s[y],p=d.n[g],g=d.t[g],m=d.n[y],y=d.t[y]}++n>255&&bn(0)}else{for(n=r-127;t<n;t+=2){var S=i[++e];o[t]=S>>4,o[t+1]=S&15}++e}var R=0;for(t=0;t<n;++t){var M=o[t];M>11&&bn(0),R+=M&&1<<M-1}var _=br(R)+1,E=1<<_,k=E-R;for(k&k-1&&bn(0),o[n++]=br(k)+1,t=0;t<n;++t){var M=o[t];++a[o[t]=M&&_+1-M]}var N=new fn(E<<1),L=N.subarray(0,E),B=N.subarray(E);for(l[_]=0,t=_;t>0;--t){var V=l[t];pa(B,t,V,l[t-1]=V+a[t]*(1<<_-t))}for(l[0]!=E&&bn(0),t=0;t<n;++t){var P=o[t];if(P){var F=l[P];pa(L,t,F,l[P]=F+(1<<_-P))}}return[e,{n:B,b:_,s:L}]},Av=ma(new fn([81,16,99,140,49,198,24,99,12,33,196,24,99,102,102,134,70,146,4]),0,6)[1],Rv=ma(new fn([33,20,196,24,99,140,33,132,16,66,8,33,132,16,66,8,33,68,68,68,68,68,68,68,68,36,9]),0,6)[1],Cv=ma(new fn([32,132,16,66,102,70,68,68,68,68,36,73,2]),0,5)[1],fm=function(i,e){for(var t=i.length,n=new Vl(t),s=0;s<t;++s)n[s]=e,e+=1<<i[s];return n},ad=new fn(new Vl([0,0,0,0,16843009,50528770,134678020,202050057,269422093]).buffer,0,36),Pv=fm(ad,0),ld=new fn(new Vl([0,0,0,0,0,0,0,0,16843009,50528770,117769220,185207048,252579084,16]).buffer,0,53),Iv=fm(ld,3),fa=function(i,e,t){var n=i.length,s=e.length,r=i[n-1],o=(1<<t.b)-1,a=-t.b;r||bn(0);for(var l=0,c=t.b,h=(n<<3)-8+br(r)-c,d=-1;h>a&&d<s;){var u=h>>3,f=(i[u]|i[u+1]<<8|i[u+2]<<16)>>(h&7);l=(l<<c|f)&o,e[++d]=t.s[l],h-=c=t.n[l]}(h!=a||d+1!=s)&&bn(0)},Lv=function(i,e,t){var n=6,s=e.length,r=s+3>>2,o=r<<1,a=r+o;fa(i.subarray(n,n+=i[0]|i[1]<<8),e.subarray(0,r),t),fa(i.subarray(n,n+=i[2]|i[3]<<8),e.subarray(r,o),t),fa(i.subarray(n,n+=i[4]|i[5]<<8),e.subarray(o,a),t),fa(i.subarray(n),e.subarray(a),t)},Nv=function(i,e,t){var n,s=e.b,r=i[s],o=r>>1&3;e.l=r&1;var a=r>>3|i[s+1]<<5|i[s+2]<<13,l=(s+=3)+a;if(o==1)return s>=i.length?void 0:(e.b=s+1,t?(pa(t,i[s],e.y,e.y+=a),t):pa(new fn(a),i[s]));if(!(l>i.length)){if(o==0)return e.b=l,t?(t.set(i.subarray(s,l),e.y),e.y+=a,t):od(i,s,l);if(o==2){var c=i[s],h=c&3,d=c>>2&3,u=c>>4,f=0,g=0;h<2?d&1?u|=i[++s]<<4|(d&2&&i[++s]<<12):u=c>>3:(g=d,d<2?(u|=(i[++s]&63)<<4,f=i[s]>>6|i[++s]<<2):d==2?(u|=i[++s]<<4|(i[++s]&3)<<12,f=i[s]>>2|i[++s]<<6):(u|=i[++s]<<4|(i[++s]&63)<<12,f=i[s]>>6|i[++s]<<2|i[++s]<<10)),++s;var y=t?t.subarray(e.y,e.y+e.m):new fn(e.m),p=y.length-u;if(h==0)y.set(i.subarray(s,s+=u),p);else if(h==1)pa(y,i[s++],p);else{var m=e.h;if(h==2){var x=Ev(i,s);f+=s-(s=x[0]),e.h=m=x[1]}else m||bn(0);(g?Lv:fa)(i.subarray(s,s+=f),y.subarray(p),m)}var A=i[s++];if(A){A==255?A=(i[s++]|i[s++]<<8)+32512:A>127&&(A=A-128<<8|i[s++]);var S=i[s++];S&3&&bn(0);for(var R=[Rv,Cv,Av],M=2;M>-1;--M){var _=S>>(M<<1)+2&3;if(_==1){var E=new fn([0,0,i[s++]]);R[M]={s:E.subarray(2,3),n:E.subarray(0,1),t:new zl(E.buffer,0,1),b:0}}else _==2?(n=ma(i,s,9-(M&1)),s=n[0],R[M]=n[1]):_==3&&(e.t||bn(0),R[M]=e.t[M])}var k=e.t=R,N=k[0],L=k[1],B=k[2],V=i[l-1];V||bn(0);var P=(l<<3)-8+br(V)-B.b,F=P>>3,X=0,G=(i[F]|i[F+1]<<8)>>(P&7)&(1<<B.b)-1;F=(P-=L.b)>>3;var oe=(i[F]|i[F+1]<<8)>>(P&7)&(1<<L.b)-1;F=(P-=N.b)>>3;var $=(i[F]|i[F+1]<<8)>>(P&7)&(1<<N.b)-1;for(++A;--A;){var J=B.s[G],ne=B.n[G],ue=N.s[$],ce=N.n[$],Q=L.s[oe],pe=L.n[oe];F=(P-=Q)>>3;var me=1<<Q,ye=me+((i[F]|i[F+1]<<8|i[F+2]<<16|i[F+3]<<24)>>>(P&7)&me-1);F=(P-=ld[ue])>>3;var ge=Iv[ue]+((i[F]|i[F+1]<<8|i[F+2]<<16)>>(P&7)&(1<<ld[ue])-1);F=(P-=ad[J])>>3;var Ve=Pv[J]+((i[F]|i[F+1]<<8|i[F+2]<<16)>>(P&7)&(1<<ad[J])-1);if(F=(P-=ne)>>3,G=B.t[G]+((i[F]|i[F+1]<<8)>>(P&7)&(1<<ne)-1),F=(P-=ce)>>3,$=N.t[$]+((i[F]|i[F+1]<<8)>>(P&7)&(1<<ce)-1),F=(P-=pe)>>3,oe=L.t[oe]+((i[F]|i[F+1]<<8)>>(P&7)&(1<<pe)-1),ye>3)e.o[2]=e.o[1],e.o[1]=e.o[0],e.o[0]=ye-=3;else{var Je=ye-(Ve!=0);Je?(ye=Je==3?e.o[0]-1:e.o[Je],Je>1&&(e.o[2]=e.o[1]),e.o[1]=e.o[0],e.o[0]=ye):ye=e.o[0]}for(var M=0;M<Ve;++M)y[X+M]=y[p+M];X+=Ve,p+=Ve;var Ue=X-ye;if(Ue<0){var rt=-Ue,ct=e.e+Ue;rt>ge&&(rt=ge);for(var M=0;M<rt;++M)y[X+M]=e.w[ct+M];X+=rt,ge-=rt,Ue=0}for(var M=0;M<ge;++M)y[X+M]=y[Ue+M];X+=ge}if(X!=p)for(;p<y.length;)y[X++]=y[p++];else X=y.length;t?e.y+=X:y=od(y,0,X)}else if(t){if(e.y+=u,p)for(var M=0;M<u;++M)y[M]=y[p+M]}else p&&(y=od(y,p));return e.b=l,y}bn(2)}},Dv=function(i,e){if(i.length==1)return i[0];for(var t=new fn(e),n=0,s=0;n<i.length;++n){var r=i[n];t.set(r,s),s+=r.length}return t};function pm(i,e){for(var t=[],n=+!e,s=0,r=0;i.length;){var o=Tv(i,n||e);if(typeof o=="object"){for(n?(e=null,o.w.length==o.u&&(t.push(e=o.w),r+=o.u)):(t.push(e),o.e=0);!o.l;){var a=Nv(i,o,e);a||bn(5),e?o.e=o.y:(t.push(a),r+=a.length,Sv(o.w,0,a.length),o.w.set(a,o.w.length-a.length))}s=o.b+o.c*4}else s=o;i=i.subarray(s)}return Dv(t,r)}var cd=[137,77,67,65,80,48,13,10],hd=37,ud=64<<20,Fv=512<<20,Li={footer:2,channel:4,message:5,chunk:6,chunkIndex:8,attachment:9,attachmentIndex:10,metadata:12,metadataIndex:13,dataEnd:15},Wn=class{constructor(e){this.bytes=e;this.view=new DataView(e.buffer,e.byteOffset,e.byteLength)}bytes;view;at=0;get left(){return this.bytes.length-this.at}u8=()=>this.view.getUint8(this.step(1));u16=()=>this.view.getUint16(this.step(2),!0);u32=()=>this.view.getUint32(this.step(4),!0);u64=()=>Number(this.view.getBigUint64(this.step(8),!0));text=()=>new TextDecoder().decode(this.take(this.u32()));take(e){let t=this.step(e);return this.bytes.subarray(t,t+e)}step(e){let t=this.at;if(!(e>=0)||t+e>this.bytes.length)throw new Error("a record ends too early");return this.at+=e,t}},Gl=class i{constructor(e){this.source=e}source;channels=new Map;metadata=new Map;attachments=new Map;chunks=[];cutOff=!1;damaged=0;static async open(e){let t=new i(e),n=await e.read(0,cd.length);if(!cd.every((s,r)=>n[r]===s))throw new Error("this is not an MCAP recording");try{await t.readIndex()}catch{t.cutOff=!0,t.chunks=[],await t.scan()}if(t.chunks.sort((s,r)=>s.startNs-r.startNs||s.offset-r.offset),t.chunks.length===0)throw new Error("this recording holds no whole chunk");return t}async readIndex(){let{source:e}=this,t=new Wn(await e.read(e.size-hd,hd));if(t.u8()!==Li.footer||t.u64()!==20)throw new Error("no footer");let n=t.u64(),s=e.size-hd-n;if(n===0||s<=0||s>Fv)throw new Error("no summary");let r=new Wn(await e.read(n,s)),o=[];for(;r.left>=9;){let[a,l]=[r.u8(),new Wn(r.take(r.u64()))];if(a===Li.channel)this.addChannel(l);else if(a===Li.chunkIndex)this.addChunkIndex(l);else if(a===Li.attachmentIndex){let[c,h]=[l.u64(),l.u64()];l.take(24),this.attachments.set(l.text(),{offset:c,length:h})}else a===Li.metadataIndex&&o.push({offset:l.u64(),length:l.u64()})}if(this.chunks.length===0)throw new Error("no chunks in the index");for(let{offset:a,length:l}of o)this.addMetadata(new Wn((await e.read(a,l)).subarray(9)))}addChannel(e){let t=e.u16();e.take(2),this.channels.set(t,e.text())}addChunkIndex(e){let[t,n,s,r]=[e.u64(),e.u64(),e.u64(),e.u64()],o=new Wn(e.take(e.u32())),a=new Set;for(;o.left>=10;)a.add(o.u16()),o.take(8);r<=ud&&s+r<=this.source.size&&this.chunks.push({startNs:t,endNs:n,offset:s,length:r,channels:a})}addMetadata(e){let t=e.text(),n=new Wn(e.take(e.u32())),s=new Map;for(;n.left>=8;)s.set(n.text(),n.text());this.metadata.set(t,s)}async scan(){let e=new Dl(this.source),t=cd.length;for(;t+9<=this.source.size;){let n=new Wn(await e.read(t,9)),[s,r]=[n.u8(),n.u64()];if(s===0||s>127||t+9+r>this.source.size||s===Li.dataEnd)return;if(s===Li.chunk&&r<=ud){let o=new Wn(await e.read(t+9,16));this.chunks.push({startNs:o.u64(),endNs:o.u64(),offset:t,length:r+9,channels:null})}else if(s===Li.channel)this.addChannel(new Wn(await e.read(t+9,r)));else if(s===Li.metadata)this.addMetadata(new Wn(await e.read(t+9,r)));else if(s===Li.attachment){let o=new Wn(await e.read(t+9,Math.min(r,4096)));o.take(16),this.attachments.set(o.text(),{offset:t,length:r+9})}t+=9+r}}async attachment(e){let t=this.attachments.get(e);if(t===void 0)return null;let n=new Wn((await this.source.read(t.offset,t.length)).subarray(9));return n.take(16),n.text(),n.text(),n.take(n.u64())}async messages(e){try{let t=new Wn((await this.source.read(e.offset,e.length)).subarray(9));t.take(16);let n=t.u64();if(n>ud)throw new Error("a chunk is too large");t.take(4);let s=t.text(),r=t.take(t.u64());if(s!=="zstd"&&s!=="")throw new Error(`compression ${s} is not known`);let o=new Wn(s==="zstd"?pm(r,new Uint8Array(n)):r),a=[];for(;o.left>=9;){let[l,c]=[o.u8(),new Wn(o.take(o.u64()))];if(l===Li.channel&&this.addChannel(c),l!==Li.message)continue;let h=c.u16();c.take(4);let d=c.u64();c.take(8),a.push({channel:h,timeNs:d,data:c.take(c.left)})}return a}catch{return this.damaged+=1,[]}}};var js=class i{constructor(e){this.bytes=e;this.view=new DataView(e.buffer,e.byteOffset,e.byteLength)}bytes;view;at=0;next(){if(this.at>=this.bytes.length)return{field:0,wire:0};let e=this.varint();return{field:Math.floor(e/8),wire:e%8}}varint(){let[e,t]=[0,1];for(let n=0;n<10;n++){let s=this.view.getUint8(this.at++);if(e+=(s&127)*t,s<128)return e;t*=128}throw new Error("a number is too long")}bytesField(){let e=this.varint(),t=this.at;if(this.at+=e,this.at>this.bytes.length)throw new Error("a field ends after its message");return this.bytes.subarray(t,this.at)}text=()=>new TextDecoder().decode(this.bytesField());doubles(){let e=this.bytesField();return new Float64Array(e.slice().buffer)}varints(){let e=new i(this.bytesField()),t=[];for(;e.at<e.bytes.length;)t.push(e.varint());return t}skip(e){if(e===0)this.varint();else if(e===1)this.at+=8;else if(e===2)this.bytesField();else if(e===5)this.at+=4;else throw new Error(`a field of kind ${e}`)}},Hl=new Float64Array;function Uv(i){let e=new js(i),t=Hl;for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===3&&s===2?t=e.doubles():e.skip(s);return t.length<7?null:{position:[t[0],t[1],t[2]],orientation:[t[3],t[4],t[5],t[6]]}}function Ov(i){let e=new js(i),t={body:0,values:Hl};for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===1?t.body=e.varint():n===2&&s===2?t.values=e.doubles():e.skip(s);return t.values.length<12?null:t}function kv(i){let e=new js(i),t={hand:null,flags:0,contacts:0,values:Hl,contact:null};for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===1?t.hand=Uv(e.bytesField()):n===5?t.flags=e.varint():n===6?t.contacts=e.varint():n===7&&s===2?t.values=e.doubles():n===8?t.contact=Ov(e.bytesField()):e.skip(s);return t}function mm(i){let e=new js(i),t={tick:0,tools:[],fault:0,lateNs:0,skipped:0,stagesNs:[],quality:0};for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===1?t.tick=e.varint():n===2?t.tools.push(kv(e.bytesField())):n===5?t.fault=e.varint():n===7?t.lateNs=e.varint():n===8?t.skipped=e.varint():n===9&&s===2?t.stagesNs=e.varints():n===10?t.quality=e.varint():e.skip(s);return t}function gm(i){let e=new js(i),t={tick:0,body:"",countU:0,countV:0,degreeU:0,degreeV:0,points:Hl};for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===1?t.tick=e.varint():n===3?t.body=e.text():n===4?t.degreeU=e.varint():n===5?t.degreeV=e.varint():n===6?t.countU=e.varint():n===7?t.countV=e.varint():n===8&&s===2?t.points=e.doubles():e.skip(s);return t}function ym(i){let e=new js(i),t={tick:0,kind:"",detail:""};for(let{field:n,wire:s}=e.next();n!==0;{field:n,wire:s}=e.next())n===1?t.tick=e.varint():n===2?t.kind=e.text():n===3?t.detail=e.text():e.skip(s);return t}var Bv=48,zv=64;function _m(i,e){let[t,n]=[0,i];for(;t<n;){let s=t+n>>>1;e(s)?t=s+1:n=s}return t-1}var Wl=class i{constructor(e,t,n,s,r){this.name=e;this.file=t;this.snapshot=n;let o=t.metadata.get("palpate.run");this.dt=Number(o?.get("dt_ns")??1e6)*1e-9||.001;let a=l=>(o?.get(l)??"").split(",").map(c=>c.trim()).filter(c=>c!=="");this.toolIds=n?.tools.map(l=>l.id)??a("tools"),this.bodyIds=n?.bodies.map(l=>l.id)??a("bodies"),this.firstTick=s,this.lastTick=r}name;file;snapshot;dt;toolIds;bodyIds;firstTick;lastTick;warnings=[];search=null;cache=new Map;get every(){return Number(this.file.metadata.get("palpate.run")?.get("thinned_every")??1)||1}get build(){return this.file.metadata.get("palpate.run")?.get("build")??"an unknown build"}get scene(){return this.file.metadata.get("palpate.run")?.get("scene")??this.snapshot?.scene_name??this.name}static async open(e,t,n){let s=await Gl.open(t),r=[],o=null;for(let y of[()=>s.attachment("scene.snapshot"),n]){if(o!==null)break;try{let p=await y();p!==null&&p.length>0&&(o=_i(Bl,p))}catch(p){r.push(`its scene cannot be read (${p instanceof Error?p.message:String(p)})`)}}let a=Number(s.metadata.get("palpate.run")?.get("dt_ns")??1e6)||1e6,l=s.metadata.get("palpate.end"),c=s.chunks.reduce((y,p)=>Math.max(y,p.endNs),0),h=Number(l?.get("first_tick")??Math.max(1,Math.round(s.chunks[0].startNs/a))),d=Number(l?.get("last_tick")??Math.round(c/a)),u=new i(e,s,o,h,Math.max(h,d));s.cutOff?r.push("it was cut off; what is whole of it is shown"):l!==void 0&&l.get("clean")==="false"&&r.push("it did not end as it should");let f=Number(l?.get("dropped_records")??0);f>0&&r.push(`${f} records were lost while recording`),o===null&&r.push("it does not hold its scene: surfaces are drawn with uniform knots, bodies that never move are missing"),u.every>1&&r.push(`it was thinned: one tick of ${u.every} is in it`);let g=s.metadata.get("palpate.run")?.get("format");return s.metadata.get("palpate.run")===void 0?r.push("it was not made by Palpate, or by a build that says nothing of itself"):g!==void 0&&Number(g)>2&&r.push(`it is of a newer format (${g})`),u.warnings.push(...r),u}async attachmentText(e){let t=await this.file.attachment(e);return t===null?null:new TextDecoder().decode(t)}chunk(e){let t=this.cache.get(e);if(t!==void 0)return this.cache.delete(e),this.cache.set(e,t),t;let n=this.decodeChunk(this.file.chunks[e]);this.cache.set(e,n);for(let s of this.cache.keys()){if(this.cache.size<=Bv)break;this.cache.delete(s)}return n}passing(e){return this.cache.get(e)??this.decodeChunk(this.file.chunks[e])}async decodeChunk(e){let t={ticks:[],nets:[],events:[]},n=await this.file.messages(e);n.some(({channel:s})=>!this.file.channels.has(s))&&await this.findChannels();for(let{channel:s,data:r}of n){let o=this.file.channels.get(s)??"";try{o==="/sim/tick"?t.ticks.push(mm(r)):o==="/sim/event"?t.events.push(ym(r)):o.startsWith("/body/")&&o.endsWith("/net")&&t.nets.push(gm(r))}catch{this.file.damaged+=1}}return t}findChannels(){return this.search??=this.goThrough()}async goThrough(){for(let e of this.file.chunks){await this.file.messages(e);let t=new Set(this.file.channels.values());if(t.has("/sim/tick")&&t.has("/sim/event")&&this.bodyIds.every(n=>t.has(`/body/${n}/net`)))return}}chunkOf(e){let t=Math.round(e*this.dt*1e9);return _m(this.file.chunks.length,n=>this.file.chunks[n].startNs<=t)}async at(e){let{chunks:t,channels:n}=this.file,s=new Map,r=this.toolIds.map(()=>null),o=new Map([...n].map(([c,h])=>[h,c])),a=null,l=this.chunkOf(e);for(let c=l;c>=0&&c>l-zv;c--){let h=this.bodyIds.filter(y=>!s.has(y));if(a!==null&&h.length===0)break;let d=t[c].channels,u=h.some(y=>{let p=o.get(`/body/${y}/net`);return d===null||p!==void 0&&d.has(p)});if(a!==null&&!u)continue;let f=await this.chunk(c);for(let y of f.nets){let p=s.get(y.body);y.tick<=e&&(p===void 0||p.tick<=y.tick)&&s.set(y.body,y)}let g=_m(f.ticks.length,y=>f.ticks[y].tick<=e);if(!(g<0||a!==null&&a.tick>=f.ticks[g].tick)){a=f.ticks[g];for(let y=g;y>=0&&r.includes(null);y--)f.ticks[y].tools.forEach(({hand:p},m)=>{p!==null&&r[m]===null&&Il(p.position)&&(r[m]=p)})}}return{tick:a,nets:s,hands:r}}};function Xl(i){if(!Array.isArray(i))return[];let e=[];for(let t of i){if(typeof t?.id!="string"||!Array.isArray(t.nodes)||!Array.isArray(t.cells)||!Array.isArray(t.young_pa))continue;let n=Float32Array.from(t.nodes),s=Uint32Array.from(t.cells),r=Float64Array.from(t.young_pa);n.length%3===0&&s.length===8*r.length&&s.every(a=>3*a<n.length)&&n.every(Number.isFinite)&&r.every(Number.isFinite)&&e.push({id:t.id,nodes:n,cells:s,youngPa:r})}return e}var Vv=[[0,1],[2,3],[4,5],[6,7],[0,2],[1,3],[4,6],[5,7],[0,4],[1,5],[2,6],[3,7]];function vm({cells:i,nodes:e}){let t=e.length/3,n=new Set;for(let o=0;o<i.length;o+=8)for(let[a,l]of Vv){let[c,h]=[i[o+a],i[o+l]];c!==h&&n.add(Math.min(c,h)*t+Math.max(c,h))}let s=new Uint32Array(2*n.size),r=0;for(let o of n)s[r++]=Math.floor(o/t),s[r++]=o%t;return s}function xm(i,e,t){let{cells:n,nodes:s,youngPa:r}=i,o=new Float32Array(3*r.length);for(let c=0;c<n.length;c++)for(let h=0;h<3;h++)o[3*(c>>3)+h]+=(s[3*n[c]+h]-t[h])/8;let a=new Float32Array(e.length/3),[l]=r;if(r.every(c=>c===l))return a.fill(l??0);for(let c=0;c<a.length;c++){let[h,d,u]=[e[3*c],e[3*c+1],e[3*c+2]],[f,g]=[0,1/0];for(let y=0;y<r.length;y++){let[p,m,x]=[o[3*y]-h,o[3*y+1]-d,o[3*y+2]-u],A=p*p+m*m+x*x;A<g&&([f,g]=[y,A])}a[c]=r[f]}return a}function bm({cells:i,nodes:e,youngPa:t}){let[n,s]=[new Float64Array(e.length/3),new Float64Array(e.length/3)];return i.forEach((r,o)=>{n[r]+=t[o>>3],s[r]+=1}),Float32Array.from(n,(r,o)=>s[o]>0?r/s[o]:0)}var Sm=Math.cos(30*Math.PI/180);function Mm(i){let e=l=>[i[3*l],i[3*l+1],i[3*l+2]],t=[1,2,4].map(l=>Wi(e(l),e(0))),n=t.map(kt),s=n.indexOf(Math.min(...n));t[s]=Ju(t[(s+1)%3],t[(s+2)%3]);let[r,o,a]=t.map(l=>Ut(l,1/kt(l)));return[...r,...o,...a].every(Number.isFinite)?[r,o,a]:null}var Sr=class{constructor(e,t,n){this.rest=t;this.origin=n;let{points:s,triangles:r}=e,o=r.map(([h,d,u])=>{let[f,g,y]=[h,d,u].map(p=>s[p]);return Ju(Wi(g,f),Wi(y,f))}),a=o.map(h=>Ut(h,1/(kt(h)||1))),l=s.map(()=>[]);r.forEach((h,d)=>h.forEach(u=>l[u].push(d))),this.indices=Uint32Array.from({length:3*r.length},(h,d)=>d),this.positions=new Float32Array(3*this.indices.length),this.normals=new Float32Array(3*this.indices.length),this.curvature=new Float32Array(this.indices.length),r.forEach((h,d)=>h.forEach((u,f)=>{let g=3*(3*d+f);this.positions.set(s[u].map((p,m)=>p-n[m]),g);let y=[0,0,0];for(let p of l[u])io(a[p],a[d])>=Sm&&(y=[0,1,2].map(m=>y[m]+o[p][m]));this.normals.set(Ut(y,1/(kt(y)||1)),g)}));let c=new Map;r.forEach((h,d)=>h.forEach((u,f)=>{let g=h[(f+1)%3],y=Math.min(u,g)*s.length+Math.max(u,g),p=c.get(y);p===void 0?c.set(y,[d,3*d+f,3*d+(f+1)%3]):(io(a[p[0]],a[d])<Sm&&this.creases.push(p[1],p[2]),c.delete(y))}));for(let[,h,d]of c.values())this.creases.push(h,d);this.restPositions=this.positions.slice(),this.restNormals=this.normals.slice(),this.restFrame=Mm(t)}rest;origin;positions;normals;indices;curvature;creases=[];restPositions;restNormals;restFrame;get vertices(){return this.indices.length}evaluate(e){let t=e.findIndex(c=>!Number.isFinite(c));if(t>=0)return t;let{rest:n,origin:s,restFrame:r}=this;if(e.every((c,h)=>c===n[h]))return this.positions.set(this.restPositions),this.normals.set(this.restNormals),-1;let o=Mm(e);if(o===null||r===null)return 0;let a=(c,h,d)=>{let u=r.map(f=>io(f,[c,h,d]));return[0,1,2].map(f=>u[0]*o[0][f]+u[1]*o[1][f]+u[2]*o[2][f])},l=[0,1,2].map(c=>s[c]-n[c]);for(let c=0;c<this.positions.length;c+=3){let h=a(this.restPositions[c]+l[0],this.restPositions[c+1]+l[1],this.restPositions[c+2]+l[2]),d=a(this.restNormals[c],this.restNormals[c+1],this.restNormals[c+2]);for(let u=0;u<3;u++)this.positions[c+u]=h[u]+e[u]-s[u],this.normals[c+u]=d[u]}return-1}},Mr=i=>i.surface.u.degree===0;function ro({degree:i,periodic:e,count:t,knots:n}){if(!e)return Float64Array.from(n);let s=n[t]-n[0],r=o=>Math.floor(o/t)*s;return Float64Array.from({length:t+1+2*i},(o,a)=>{let l=a-i;return n[(l%t+t)%t]+r(l)})}function oo(i){let{degree:e,periodic:t,count:n,knots:s}=i,r=t?n+1:n+e+1;if(s.length!==r)return`${s.length} knots where ${r} are needed`;if(n<e+1&&!t)return`${n} control points are too few for degree ${e}`;for(let o=0;o<s.length;o++)if(!Number.isFinite(s[o])||o>0&&s[o]<s[o-1])return`knot ${o} is ${s[o]}`;return null}function wm(i,e){return Float64Array.from({length:e+i+1},(t,n)=>Math.min(Math.max(n-i,0),e-i))}function Gv(i,e,t,n,s,r){let o=e,a=Array.from({length:o+1},()=>new Array(o+1).fill(0)),l=new Float64Array(o+1),c=new Float64Array(o+1);a[0][0]=1;for(let h=1;h<=o;h++){l[h]=n-i[t+1-h],c[h]=i[t+h]-n;let d=0;for(let u=0;u<h;u++){a[h][u]=c[u+1]+l[h-u];let f=a[u][h-1]/a[h][u];a[u][h]=d+c[u+1]*f,d=l[h-u]*f}a[h][h]=d}for(let h=0;h<=o;h++)s[0][r+h]=a[h][o];for(let h=0;h<=o;h++){let[d,u]=[0,1],f=[new Float64Array(o+1),new Float64Array(o+1)];f[0][0]=1;let g=o;for(let y=1;y<=2;y++){if(y>o){s[y][r+h]=0;continue}let p=0,m=h-y,x=o-y;h>=y&&(f[u][0]=f[d][0]/a[x+1][m],p=f[u][0]*a[m][x]);let A=m>=-1?1:-m,S=h-1<=x?y-1:o-h;for(let R=A;R<=S;R++)f[u][R]=(f[d][R]-f[d][R-1])/a[x+1][m+R],p+=f[u][R]*a[m+R][x];h<=x&&(f[u][y]=-f[d][y-1]/a[x+1][h],p+=f[u][y]*a[h][x]),s[y][r+h]=p*g,g*=o-y,[d,u]=[u,d]}}}function Hv(i,e,t,n){let{degree:s,count:r}=i,o=ro(i),a=s+1,l=()=>new Float64Array(a*e.length),c=[l(),l(),l()];return e.forEach(({span:h,t:d},u)=>Gv(o,s,h,d,c,u*a)),{count:e.length,width:a,params:Float64Array.from(e,({t:h})=>h),first:Int32Array.from(e,({span:h})=>h-s),wrap:r,values:c,cells:Int32Array.from(t),knots:Int32Array.from(n)}}function Tm(i,e){return[i.degree,e.length-1-i.degree]}function Em(i,e){let t=ro(i),[n,s]=Tm(i,t),r=[],o=[],a=[],l=0;for(let c=n;c<s;c++){let[h,d]=[t[c],t[c+1]];if(!(d>h))continue;let u=0;for(let f=c;f>=0&&t[f]===h;f--)u+=1;(l===0||u>=i.degree)&&(a.push(r.length),r.push({span:c,t:h}));for(let f=1;f<=e;f++)o.push(r.length-1),r.push({span:c,t:f===e?d:h+(d-h)*f/e});a.push(r.length-1),l+=1}return Hv(i,r,o,a)}function Am(i){let e=ro(i),[t,n]=Tm(i,e),s=0;for(let r=t;r<n;r++)e[r+1]>e[r]&&(s+=1);return s}function ga({degree:i,periodic:e,count:t,knots:n}){let s=new Set;if(e)return s;for(let r=1;r+i<n.length;r++)n[r]===n[r+i]&&n[r]>n[r-1]&&n[r]>n[0]&&n[r]<n[t]&&s.add(r-1);return s}var ya=class{constructor(e,t,n,s){this.surface=e;this.origin=t;this.u=n;this.v=s;let r=n.count*s.count;this.positions=new Float32Array(3*r),this.normals=new Float32Array(3*r),this.curvature=new Float32Array(r),this.wide=e.weights===null?3:4,this.homogeneous=new Float64Array(this.wide*e.u.count*e.v.count);let o=()=>new Float64Array(this.wide*e.v.count);this.rows=[o(),o(),o()],this.indices=new Uint32Array(6*n.cells.length*s.cells.length);let a=0;for(let l of n.cells)for(let c of s.cells){let h=l*s.count+c;this.indices.set([h,h+s.count,h+s.count+1,h,h+s.count+1,h+1],a),a+=6}}surface;origin;u;v;positions;normals;indices;curvature;wide;homogeneous;rows;degenerate=[];least=[0,0];get vertices(){return this.u.count*this.v.count}evaluate(e,t=!1){let n=e.findIndex(c=>!Number.isFinite(c));if(n>=0)return n;let{u:s,v:r,wide:o}=this;this.lift(e),this.degenerate.length=0;let a=new Float64Array(6*o),l=t?3:2;for(let c=0;c<s.count;c++){if(this.sumRows(c,l),o===3&&!t){this.plainRow(c);continue}for(let h=0;h<r.count;h++)this.sumColumns(h,a,t),o===4&&Wv(a,t),this.store(c*r.count+h,a,t)}return this.mendPoles(),-1}lift(e){let{homogeneous:t,wide:n,origin:s}=this,r=this.surface.weights,o=0;for(let a=0;3*a<e.length;a++){let l=r===null?1:r[a];for(let c=0;c<3;c++)t[n*a+c]=l*(e[3*a+c]-s[c]),o=Math.max(o,Math.abs(e[3*a+c]-e[c]));n===4&&(t[4*a+3]=l)}[this.u,this.v].forEach(({params:a,count:l},c)=>{this.least[c]=1e-7*o/(a[l-1]-a[0])})}sumRows(e,t){let{u:n,homogeneous:s,wide:r}=this,o=r*this.surface.v.count;for(let a=0;a<t;a++){let l=this.rows[a].fill(0);for(let c=0;c<n.width;c++){let h=n.values[a][e*n.width+c],d=(n.first[e]+c)%n.wrap*o;for(let u=0;u<o;u++)l[u]+=h*s[d+u]}}}plainRow(e){let{v:t,positions:n,normals:s,least:r}=this,[o,a]=this.rows,[l,c]=t.values,{width:h,wrap:d,first:u}=t;for(let f=0;f<t.count;f++){let g=0,y=0,p=0,m=0,x=0,A=0,S=0,R=0,M=0,_=f*h;for(let X=0;X<h;X++,_++){let G=u[f]+X;for(;G>=d;)G-=d;let oe=3*G,$=l[_],J=c[_],ne=o[oe],ue=o[oe+1],ce=o[oe+2];g+=$*ne,y+=$*ue,p+=$*ce,m+=$*a[oe],x+=$*a[oe+1],A+=$*a[oe+2],S+=J*ne,R+=J*ue,M+=J*ce}let E=e*t.count+f,k=3*E;n[k]=g,n[k+1]=y,n[k+2]=p;let N=x*M-A*R,L=A*S-m*M,B=m*R-x*S,V=Math.sqrt(m*m+x*x+A*A),P=Math.sqrt(S*S+R*R+M*M),F=Math.sqrt(N*N+L*L+B*B);if(V<=r[0]||P<=r[1]||!(F>1e-9*V*P)){this.degenerate.push(E),s[k]=s[k+1]=s[k+2]=0;continue}s[k]=N/F,s[k+1]=L/F,s[k+2]=B/F}}sumColumns(e,t,n){let{v:s,wide:r,rows:o}=this,[a,l,c]=s.values;t.fill(0);for(let h=0;h<s.width;h++){let d=e*s.width+h,u=(s.first[e]+h)%s.wrap*r;for(let f=0;f<r;f++){let[g,y]=[o[0][u+f],o[1][u+f]];t[f]+=a[d]*g,t[r+f]+=a[d]*y,t[2*r+f]+=l[d]*g,n&&(t[3*r+f]+=a[d]*o[2][u+f],t[4*r+f]+=l[d]*y,t[5*r+f]+=c[d]*g)}}}store(e,t,n){let s=this.wide,r=3*e;for(let M=0;M<3;M++)this.positions[r+M]=t[M];let[o,a,l]=[t[s],t[s+1],t[s+2]],[c,h,d]=[t[2*s],t[2*s+1],t[2*s+2]],u=a*d-l*h,f=l*c-o*d,g=o*h-a*c,y=Math.hypot(u,f,g),[p,m]=[Math.hypot(o,a,l),Math.hypot(c,h,d)];if(p<=this.least[0]||m<=this.least[1]||!(y>1e-9*p*m)){this.degenerate.push(e),this.normals.fill(0,r,r+3),this.curvature[e]=NaN;return}if(this.normals[r]=u/y,this.normals[r+1]=f/y,this.normals[r+2]=g/y,!n)return;let x=M=>(t[M*s]*u+t[M*s+1]*f+t[M*s+2]*g)/y,[A,S,R]=[o*o+a*a+l*l,o*c+a*h+l*d,c*c+h*h+d*d];this.curvature[e]=(A*x(5)-2*S*x(4)+R*x(3))/(2*(A*R-S*S))}mendPoles(){if(this.degenerate.length===0)return;let{u:e,v:t,normals:n,positions:s,curvature:r}=this,o=new Map;for(let a of this.degenerate){let l=3*a,c=[0,1,2].map(d=>Math.fround(s[l+d]).toPrecision(5)).join(),h=o.get(c);h===void 0?o.set(c,[a]):h.push(a)}for(let a of o.values()){let l=[0,0,0],[c,h]=[0,0];for(let u of a){let[f,g]=[Math.floor(u/t.count),u%t.count];for(let[y,p]of[[-1,0],[1,0],[0,-1],[0,1]]){let[m,x]=[f+y,g+p];if(m<0||x<0||m>=e.count||x>=t.count)continue;let A=m*t.count+x;for(let S=0;S<3;S++)l[S]+=n[3*A+S];Number.isFinite(r[A])&&([c,h]=[c+r[A],h+1])}}let d=Math.hypot(l[0],l[1],l[2])||1;for(let u of a){for(let f=0;f<3;f++)n[3*u+f]=l[f]/d;r[u]=h>0?c/h:0}}}};function Wv(i,e){let[t,n,s]=[i[3],i[7],i[11]],[r,o,a]=[i[15],i[19],i[23]];for(let l=0;l<3;l++)i[l]/=t,i[4+l]=(i[4+l]-n*i[l])/t,i[8+l]=(i[8+l]-s*i[l])/t,e&&(i[12+l]=(i[12+l]-2*n*i[4+l]-r*i[l])/t,i[16+l]=(i[16+l]-n*i[8+l]-s*i[4+l]-o*i[l])/t,i[20+l]=(i[20+l]-2*s*i[8+l]-a*i[l])/t)}function ql(i,e,t){if(oo(i.u)!==null||oo(i.v)!==null)return null;let n=s=>{let r=Math.round(t/Am(s));return Em(s,s.degree===1?1:Math.min(Math.max(r,1),12))};return new ya(i,e,n(i.u),n(i.v))}function $l(i,e){let t=document.createElement("a");t.href=URL.createObjectURL(e),t.download=i,t.click(),setTimeout(()=>URL.revokeObjectURL(t.href),1e4)}function Yl(i,e){return`${i.name.replace(/[^\w-]+/g,"-")||"palpate"}-${String(i.tick).padStart(7,"0")}.${e}`}function Rm(i){let e=[`# ${i.name}, tick ${i.tick}, metres`],t=1;for(let n of i.bodies){if(n.fault!==null)continue;let{middle:s}=new ci().take(n.points),r=s,o=i.outlineOf(n),a=Mr(n)&&o!==void 0?new Sr(o,n.rest,r):null,l=a??ql(n.surface,r,96);if(l===null||l.evaluate(n.points)>=0)continue;e.push(`o ${n.id}`);for(let[u,f]of a!==null?[]:[["u",n.surface.u],["v",n.surface.v]])e.push(`#net ${u} degree ${f.degree} count ${f.count} ${f.periodic?"periodic":""} knots ${Array.from(f.knots).join(" ")}`);for(let u=0;a===null&&u<n.points.length;u+=3)e.push(`#net p ${n.points[u]} ${n.points[u+1]} ${n.points[u+2]}`);let{positions:c,normals:h,indices:d}=l;for(let u=0;u<c.length;u+=3)e.push(`v ${c[u]+s[0]} ${c[u+1]+s[1]} ${c[u+2]+s[2]}`);for(let u=0;u<h.length;u+=3)e.push(`vn ${h[u].toFixed(6)} ${h[u+1].toFixed(6)} ${h[u+2].toFixed(6)}`);for(let u=0;u<d.length;u+=3){let f=[0,1,2].map(g=>t+d[u+g]);e.push(`f ${f.map(g=>`${g}//${g}`).join(" ")}`)}t+=l.vertices}return e.join(`
`)+`
`}function Zl(i){let e=Math.abs(i);if(e!==0&&(e<1e-4||e>=1e16)){let[n,s]=i.toExponential().split("e");return`${n}${n.includes(".")?"":"."}E${s.replace("+","")}`}let t=Object.is(i,-0)?"-0":String(i);return t.includes(".")?t:`${t}.0`}function Cm(i){let e=[],t=[];for(let n=0;n<i.length;n++)n>0&&i[n]===i[n-1]?t[t.length-1]+=1:(e.push(i[n]),t.push(1));return{values:e,times:t}}var wr=i=>`(${i.join(",")})`,Pm=i=>i?".T.":".F.",Kl=i=>`'${i.replace(/[^\x20-\x7e]/g,"_").replace(/'/g,"''").replace(/\\/g,"\\\\")}'`;function fd(i){if(i.fault!==null)return i.fault;if(i.surface.u.degree===0)return`${i.id} is a part: its STEP file is the one that the scene names`;let e=oo(i.surface.u)??oo(i.surface.v);return e!==null?`${i.id}: ${e}`:[i.surface.u,i.surface.v].some(n=>ga(n).size>0)?`${i.id} is in several pieces, which STEP does not have`:null}var Im=({degree:i,periodic:e,count:t})=>e?t+i:t,dd=class{lines=[];next;constructor(e){this.next=e}surface(e,t){let{u:n,v:s,weights:r}=t.surface,[o,a]=[Im(n),Im(s)],l=(m,x)=>m%n.count*s.count+x%s.count,c=(m,x)=>[0,1,2].every(A=>t.points[3*m+A]===t.points[3*x+A]),h=[n.periodic||Array.from({length:a},(m,x)=>c(l(0,x),l(o-1,x))).every(Boolean),s.periodic||Array.from({length:o},(m,x)=>c(l(x,0),l(x,a-1))).every(Boolean)],d=this.next,u=m=>wr(Array.from({length:o},(x,A)=>`
${wr(Array.from({length:a},(S,R)=>m(A*a+R)))}`)),[f,g]=[Cm(ro(n)),Cm(ro(s))],y=`${n.degree},${s.degree},${u(m=>`#${d+m}`)},.UNSPECIFIED.,${Pm(h[0])},${Pm(h[1])},.U.`,p=`${wr(f.times.map(String))},${wr(g.times.map(String))},
${wr(f.values.map(Zl))},
${wr(g.values.map(Zl))},.UNSPECIFIED.`;if(r===null)this.lines.push(`#${e}=B_SPLINE_SURFACE_WITH_KNOTS(${Kl(t.id)},${y},
${p});`);else{let m=u(x=>Zl(r[l(Math.floor(x/a),x%a)]));this.lines.push(`#${e}=(BOUNDED_SURFACE()B_SPLINE_SURFACE(${y})
B_SPLINE_SURFACE_WITH_KNOTS(${p})
GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(${m})
REPRESENTATION_ITEM(${Kl(t.id)})SURFACE());`)}for(let m=0;m<o;m++)for(let x=0;x<a;x++){let A=3*l(m,x),[S,R,M]=[0,1,2].map(_=>Zl(t.points[A+_]));this.lines.push(`#${this.next++}=CARTESIAN_POINT('',(${S},${R},${M}));`)}}};function Lm(i){let e=i.bodies.filter(r=>fd(r)===null);if(e.length===0)return null;let t=e.map((r,o)=>22+o),n=new dd(22+e.length);e.forEach((r,o)=>n.surface(t[o],r));let s=Kl(i.name);return["ISO-10303-21;","HEADER;","FILE_DESCRIPTION(('B-spline surfaces'),'2;1');",`FILE_NAME(${Kl(`${i.name}, tick ${i.tick}`)},'1970-01-01T00:00:00',(''),(''),'palpate','palpate','');`,"FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));","ENDSEC;","DATA;","#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');","#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);","#3=PRODUCT_CONTEXT('',#1,'mechanical');",`#4=PRODUCT(${s},${s},'',(#3));`,"#5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));","#6=PRODUCT_DEFINITION_FORMATION('','',#4);","#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');","#8=PRODUCT_DEFINITION('design','',#6,#7);","#9=PRODUCT_DEFINITION_SHAPE('','',#8);","#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));","#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));","#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());","#13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-9),#10,'distance_accuracy_value','');","#14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));","#15=CARTESIAN_POINT('',(0.,0.,0.));","#16=DIRECTION('',(0.,0.,1.));","#17=DIRECTION('',(1.,0.,0.));","#18=AXIS2_PLACEMENT_3D('',#15,#16,#17);","#19=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#18,#20),#14);",`#20=GEOMETRIC_SET('',${wr(t.map(r=>`#${r}`))});`,"#21=SHAPE_DEFINITION_REPRESENTATION(#9,#19);",...n.lines,"ENDSEC;","END-ISO-10303-21;",""].join(`
`)}var Ui={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},ji={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},fg=0,Wd=1,pg=2;var Lr=1,mg=2,Oo=3,ur=0,ai=1,Kn=2,Nr=0,ko=1,Xd=2,qd=3,$d=4,gg=5;var Dr=100,yg=101,_g=102,vg=103,xg=104,bg=200,Sg=201,Mg=202,wg=203,Yd=204,Zd=205,Tg=206,Eg=207,Ag=208,Rg=209,Cg=210,Pg=211,Ig=212,Lg=213,Ng=214,wc=0,Tc=1,Ec=2,Mo=3,Ac=4,Rc=5,Cc=6,Pc=7,th=0,Dg=1,Fg=2,Oi=0,Kd=1,Jd=2,jd=3,Qd=4,ef=5,tf=6,nf=7;var sf=300,Fr=301,Bo=302,nh=303,ih=304,Ic=1e3,ms=1001,Lc=1002,zn=1003,Ug=1004;var Ja=1005;var ri=1006,sh=1007;var ks=1008;var ui=1009,rf=1010,of=1011,zo=1012,rh=1013,Qi=1014,ki=1015,es=1016,oh=1017,ah=1018,Ur=1020,af=35902,lf=35899,cf=1021,hf=1022,ts=1023,Ns=1026,Bs=1027,lh=1028,ch=1029,dr=1030,hh=1031;var uh=1033,ja=33776,Qa=33777,el=33778,tl=33779,dh=35840,fh=35841,ph=35842,mh=35843,gh=36196,yh=37492,_h=37496,vh=37488,xh=37489,nl=37490,bh=37491,Sh=37808,Mh=37809,wh=37810,Th=37811,Eh=37812,Ah=37813,Rh=37814,Ch=37815,Ph=37816,Ih=37817,Lh=37818,Nh=37819,Dh=37820,Fh=37821,Uh=36492,Oh=36494,kh=36495,Bh=36283,zh=36284,il=36285,Vh=36286;var Ra=2300,Nc=2301,Sc=2302,Fd=2303,Ud=2400,Od=2401,kd=2402;var Og=3200;var Gh=0,kg=1,zs="",bi="srgb",Ca="srgb-linear",Pa="linear",Ct="srgb";var Mc=7680;var Bg=519,zg=512,Vg=513,Gg=514,uf=515,Hg=516,Wg=517,df=518,ff=519,Xg=35044;var pf="300 es",Di=2e3,wo=2001;function Xv(i){for(let e=i.length-1;e>=0;--e)if(i[e]>=65535)return!0;return!1}function qv(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function Ia(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function qg(){let i=Ia("canvas");return i.style.display="block",i}var Nm={},To=null;function mf(...i){let e="THREE."+i.shift();To?To("log",e,...i):console.log(e,...i)}function $g(i){let e=i[0];if(typeof e=="string"&&e.startsWith("TSL:")){let t=i[1];t&&t.isStackTrace?i[0]+=" "+t.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function Ye(...i){i=$g(i);let e="THREE."+i.shift();if(To)To("warn",e,...i);else{let t=i[0];t&&t.isStackTrace?console.warn(t.getError(e)):console.warn(e,...i)}}function tt(...i){i=$g(i);let e="THREE."+i.shift();if(To)To("error",e,...i);else{let t=i[0];t&&t.isStackTrace?console.error(t.getError(e)):console.error(e,...i)}}function Ta(...i){let e=i.join(" ");e in Nm||(Nm[e]=!0,Ye(...i))}function Yg(i,e,t){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(e,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,t);break;default:n()}}setTimeout(r,t)})}var Zg={[wc]:wc,[Ec]:Cc,[Ac]:Ac,[Mo]:Rc,[Tc]:Tc,[Cc]:Ec,[Pc]:Pc,[Rc]:Mo},Ki=class{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[e]===void 0&&(n[e]=[]),n[e].indexOf(t)===-1&&n[e].push(t)}hasEventListener(e,t){let n=this._listeners;return n===void 0?!1:n[e]!==void 0&&n[e].indexOf(t)!==-1}removeEventListener(e,t){let n=this._listeners;if(n===void 0)return;let s=n[e];if(s!==void 0){let r=s.indexOf(t);r!==-1&&s.splice(r,1)}}dispatchEvent(e){let t=this._listeners;if(t===void 0)return;let n=t[e.type];if(n!==void 0){e.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,e);e.target=null}}},Yn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],Dm=1234567,Ea=Math.PI/180,Eo=180/Math.PI;function Vo(){let i=Math.random()*4294967295|0,e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(Yn[i&255]+Yn[i>>8&255]+Yn[i>>16&255]+Yn[i>>24&255]+"-"+Yn[e&255]+Yn[e>>8&255]+"-"+Yn[e>>16&15|64]+Yn[e>>24&255]+"-"+Yn[t&63|128]+Yn[t>>8&255]+"-"+Yn[t>>16&255]+Yn[t>>24&255]+Yn[n&255]+Yn[n>>8&255]+Yn[n>>16&255]+Yn[n>>24&255]).toLowerCase()}function gt(i,e,t){return Math.max(e,Math.min(t,i))}function gf(i,e){return(i%e+e)%e}function $v(i,e,t,n,s){return n+(i-e)*(s-n)/(t-e)}function Yv(i,e,t){return i!==e?(t-i)/(e-i):0}function Aa(i,e,t){return(1-t)*i+t*e}function Zv(i,e,t,n){return Aa(i,e,1-Math.exp(-t*n))}function Kv(i,e=1){return e-Math.abs(gf(i,e*2)-e)}function Jv(i,e,t){return i<=e?0:i>=t?1:(i=(i-e)/(t-e),i*i*(3-2*i))}function jv(i,e,t){return i<=e?0:i>=t?1:(i=(i-e)/(t-e),i*i*i*(i*(i*6-15)+10))}function Qv(i,e){return i+Math.floor(Math.random()*(e-i+1))}function ex(i,e){return i+Math.random()*(e-i)}function tx(i){return i*(.5-Math.random())}function nx(i){i!==void 0&&(Dm=i);let e=Dm+=1831565813;return e=Math.imul(e^e>>>15,e|1),e^=e+Math.imul(e^e>>>7,e|61),((e^e>>>14)>>>0)/4294967296}function ix(i){return i*Ea}function sx(i){return i*Eo}function rx(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function ox(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function yf(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function ax(i,e,t,n,s){let r=Math.cos,o=Math.sin,a=r(t/2),l=o(t/2),c=r((e+n)/2),h=o((e+n)/2),d=r((e-n)/2),u=o((e-n)/2),f=r((n-e)/2),g=o((n-e)/2);switch(s){case"XYX":i.set(a*h,l*d,l*u,a*c);break;case"YZY":i.set(l*u,a*h,l*d,a*c);break;case"ZXZ":i.set(l*d,l*u,a*h,a*c);break;case"XZX":i.set(a*h,l*g,l*f,a*c);break;case"YXY":i.set(l*f,a*h,l*g,a*c);break;case"ZYZ":i.set(l*g,l*f,a*h,a*c);break;default:Ye("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function _f(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function Kg(i,e){if(e.constructor===Float32Array)return i;let t=_f(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/t,-1)}function Jg(i,e){if(e.constructor===Float32Array)return i;let t=_f(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*t)}var vf={DEG2RAD:Ea,RAD2DEG:Eo,generateUUID:Vo,clamp:gt,euclideanModulo:gf,mapLinear:$v,inverseLerp:Yv,lerp:Aa,damp:Zv,pingpong:Kv,smoothstep:Jv,smootherstep:jv,randInt:Qv,randFloat:ex,randFloatSpread:tx,seededRandom:nx,degToRad:ix,radToDeg:sx,isPowerOfTwo:rx,ceilPowerOfTwo:ox,floorPowerOfTwo:yf,setQuaternionFromProperEuler:ax,normalize:Jg,denormalize:Kg},Ze=class{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw new Error("THREE.Vector2: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){let t=this.x,n=this.y,s=e.elements;return this.x=s[0]*t+s[3]*n+s[6],this.y=s[1]*t+s[4]*n+s[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(gt(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y;return t*t+n*n}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){let n=Math.cos(t),s=Math.sin(t),r=this.x-e.x,o=this.y-e.y;return this.x=r*n-o*s+e.x,this.y=r*s+o*n+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},oi=class{constructor(e=0,t=0,n=0,s=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=n,this._w=s}static slerpFlat(e,t,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],d=n[s+3],u=r[o+0],f=r[o+1],g=r[o+2],y=r[o+3];if(d!==y||l!==u||c!==f||h!==g){let p=l*u+c*f+h*g+d*y;p<0&&(u=-u,f=-f,g=-g,y=-y,p=-p);let m=1-a;if(p<.9995){let x=Math.acos(p),A=Math.sin(x);m=Math.sin(m*x)/A,a=Math.sin(a*x)/A,l=l*m+u*a,c=c*m+f*a,h=h*m+g*a,d=d*m+y*a}else{l=l*m+u*a,c=c*m+f*a,h=h*m+g*a,d=d*m+y*a;let x=1/Math.sqrt(l*l+c*c+h*h+d*d);l*=x,c*=x,h*=x,d*=x}}e[t]=l,e[t+1]=c,e[t+2]=h,e[t+3]=d}static multiplyQuaternionsFlat(e,t,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],d=r[o],u=r[o+1],f=r[o+2],g=r[o+3];return e[t]=a*g+h*d+l*f-c*u,e[t+1]=l*g+h*u+c*d-a*f,e[t+2]=c*g+h*f+a*u-l*d,e[t+3]=h*g-a*d-l*u-c*f,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,n,s){return this._x=e,this._y=t,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){let n=e._x,s=e._y,r=e._z,o=e._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),d=a(r/2),u=l(n/2),f=l(s/2),g=l(r/2);switch(o){case"XYZ":this._x=u*h*d+c*f*g,this._y=c*f*d-u*h*g,this._z=c*h*g+u*f*d,this._w=c*h*d-u*f*g;break;case"YXZ":this._x=u*h*d+c*f*g,this._y=c*f*d-u*h*g,this._z=c*h*g-u*f*d,this._w=c*h*d+u*f*g;break;case"ZXY":this._x=u*h*d-c*f*g,this._y=c*f*d+u*h*g,this._z=c*h*g+u*f*d,this._w=c*h*d-u*f*g;break;case"ZYX":this._x=u*h*d-c*f*g,this._y=c*f*d+u*h*g,this._z=c*h*g-u*f*d,this._w=c*h*d+u*f*g;break;case"YZX":this._x=u*h*d+c*f*g,this._y=c*f*d+u*h*g,this._z=c*h*g-u*f*d,this._w=c*h*d-u*f*g;break;case"XZY":this._x=u*h*d-c*f*g,this._y=c*f*d-u*h*g,this._z=c*h*g+u*f*d,this._w=c*h*d+u*f*g;break;default:Ye("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){let n=t/2,s=Math.sin(n);return this._x=e.x*s,this._y=e.y*s,this._z=e.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(e){let t=e.elements,n=t[0],s=t[4],r=t[8],o=t[1],a=t[5],l=t[9],c=t[2],h=t[6],d=t[10],u=n+a+d;if(u>0){let f=.5/Math.sqrt(u+1);this._w=.25/f,this._x=(h-l)*f,this._y=(r-c)*f,this._z=(o-s)*f}else if(n>a&&n>d){let f=2*Math.sqrt(1+n-a-d);this._w=(h-l)/f,this._x=.25*f,this._y=(s+o)/f,this._z=(r+c)/f}else if(a>d){let f=2*Math.sqrt(1+a-n-d);this._w=(r-c)/f,this._x=(s+o)/f,this._y=.25*f,this._z=(l+h)/f}else{let f=2*Math.sqrt(1+d-n-a);this._w=(o-s)/f,this._x=(r+c)/f,this._y=(l+h)/f,this._z=.25*f}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let n=e.dot(t)+1;return n<1e-8?(n=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=n):(this._x=0,this._y=-e.z,this._z=e.y,this._w=n)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=n),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(gt(this.dot(e),-1,1)))}rotateTowards(e,t){let n=this.angleTo(e);if(n===0)return this;let s=Math.min(1,t/n);return this.slerp(e,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x=this._x*e,this._y=this._y*e,this._z=this._z*e,this._w=this._w*e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){let n=e._x,s=e._y,r=e._z,o=e._w,a=t._x,l=t._y,c=t._z,h=t._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(e,t){let n=e._x,s=e._y,r=e._z,o=e._w,a=this.dot(e);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-t;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,t=Math.sin(t*c)/h,this._x=this._x*l+n*t,this._y=this._y*l+s*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this._onChangeCallback()}else this._x=this._x*l+n*t,this._y=this._y*l+s*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this.normalize();return this}slerpQuaternions(e,t,n){return this.copy(e).slerp(t,n)}random(){let e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(e),s*Math.cos(e),r*Math.sin(t),r*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},W=class{static{this.prototype.isVector3=!0}constructor(e=0,t=0,n=0){this.x=e,this.y=t,this.z=n}set(e,t,n){return n===void 0&&(n=this.z),this.x=e,this.y=t,this.z=n,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw new Error("THREE.Vector3: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(Fm.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(Fm.setFromAxisAngle(e,t))}applyMatrix3(e){let t=this.x,n=this.y,s=this.z,r=e.elements;return this.x=r[0]*t+r[3]*n+r[6]*s,this.y=r[1]*t+r[4]*n+r[7]*s,this.z=r[2]*t+r[5]*n+r[8]*s,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){let t=this.x,n=this.y,s=this.z,r=e.elements,o=1/(r[3]*t+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*t+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*t+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*t+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(e){let t=this.x,n=this.y,s=this.z,r=e.x,o=e.y,a=e.z,l=e.w,c=2*(o*s-a*n),h=2*(a*t-r*s),d=2*(r*n-o*t);return this.x=t+l*c+o*d-a*h,this.y=n+l*h+a*c-r*d,this.z=s+l*d+r*h-o*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){let t=this.x,n=this.y,s=this.z,r=e.elements;return this.x=r[0]*t+r[4]*n+r[8]*s,this.y=r[1]*t+r[5]*n+r[9]*s,this.z=r[2]*t+r[6]*n+r[10]*s,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this.z=gt(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this.z=gt(this.z,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){let n=e.x,s=e.y,r=e.z,o=t.x,a=t.y,l=t.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(e){let t=e.lengthSq();if(t===0)return this.set(0,0,0);let n=e.dot(this)/t;return this.copy(e).multiplyScalar(n)}projectOnPlane(e){return pd.copy(this).projectOnVector(e),this.sub(pd)}reflect(e){return this.sub(pd.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(gt(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y,s=this.z-e.z;return t*t+n*n+s*s}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,n){let s=Math.sin(t)*e;return this.x=s*Math.sin(n),this.y=Math.cos(t)*e,this.z=s*Math.cos(n),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,n){return this.x=e*Math.sin(t),this.y=n,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){let t=this.setFromMatrixColumn(e,0).length(),n=this.setFromMatrixColumn(e,1).length(),s=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=n,this.z=s,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let e=Math.random()*Math.PI*2,t=Math.random()*2-1,n=Math.sqrt(1-t*t);return this.x=n*Math.cos(e),this.y=t,this.z=n*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},pd=new W,Fm=new oi,st=class{static{this.prototype.isMatrix3=!0}constructor(e,t,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,n,s,r,o,a,l,c)}set(e,t,n,s,r,o,a,l,c){let h=this.elements;return h[0]=e,h[1]=s,h[2]=a,h[3]=t,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],this}extractBasis(e,t,n){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(e){let t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,s=t.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],d=n[7],u=n[2],f=n[5],g=n[8],y=s[0],p=s[3],m=s[6],x=s[1],A=s[4],S=s[7],R=s[2],M=s[5],_=s[8];return r[0]=o*y+a*x+l*R,r[3]=o*p+a*A+l*M,r[6]=o*m+a*S+l*_,r[1]=c*y+h*x+d*R,r[4]=c*p+h*A+d*M,r[7]=c*m+h*S+d*_,r[2]=u*y+f*x+g*R,r[5]=u*p+f*A+g*M,r[8]=u*m+f*S+g*_,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8];return t*o*h-t*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],d=h*o-a*c,u=a*l-h*r,f=c*r-o*l,g=t*d+n*u+s*f;if(g===0)return this.set(0,0,0,0,0,0,0,0,0);let y=1/g;return e[0]=d*y,e[1]=(s*c-h*n)*y,e[2]=(a*n-s*o)*y,e[3]=u*y,e[4]=(h*t-s*l)*y,e[5]=(s*r-a*t)*y,e[6]=f*y,e[7]=(n*l-c*t)*y,e[8]=(o*t-n*r)*y,this}transpose(){let e,t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){let t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+e,-s*c,s*l,-s*(-c*o+l*a)+a+t,0,0,1),this}scale(e,t){return Ta("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(md.makeScale(e,t)),this}rotate(e){return Ta("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(md.makeRotation(-e)),this}translate(e,t){return Ta("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(md.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,n,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){let t=this.elements,n=e.elements;for(let s=0;s<9;s++)if(t[s]!==n[s])return!1;return!0}fromArray(e,t=0){for(let n=0;n<9;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e}clone(){return new this.constructor().fromArray(this.elements)}},md=new st,Um=new st().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),Om=new st().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function lx(){let i={enabled:!0,workingColorSpace:Ca,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Ct&&(s.r=Ls(s.r),s.g=Ls(s.g),s.b=Ls(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Ct&&(s.r=So(s.r),s.g=So(s.g),s.b=So(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===zs?Pa:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},e=[.64,.33,.3,.6,.15,.06],t=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[Ca]:{primaries:e,whitePoint:n,transfer:Pa,toXYZ:Um,fromXYZ:Om,luminanceCoefficients:t,workingColorSpaceConfig:{unpackColorSpace:bi},outputColorSpaceConfig:{drawingBufferColorSpace:bi}},[bi]:{primaries:e,whitePoint:n,transfer:Ct,toXYZ:Um,fromXYZ:Om,luminanceCoefficients:t,outputColorSpaceConfig:{drawingBufferColorSpace:bi}}}),i}var vt=lx();function Ls(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function So(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var ao,Dc=class{static getDataURL(e,t="image/png"){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>"u")return e.src;let n;if(e instanceof HTMLCanvasElement)n=e;else{ao===void 0&&(ao=Ia("canvas")),ao.width=e.width,ao.height=e.height;let s=ao.getContext("2d");e instanceof ImageData?s.putImageData(e,0,0):s.drawImage(e,0,0,e.width,e.height),n=ao}return n.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<"u"&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&e instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&e instanceof ImageBitmap){let t=Ia("canvas");t.width=e.width,t.height=e.height;let n=t.getContext("2d");n.drawImage(e,0,0,e.width,e.height);let s=n.getImageData(0,0,e.width,e.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=Ls(r[o]/255)*255;return n.putImageData(s,0,0),t}else if(e.data){let t=e.data.slice(0);for(let n=0;n<t.length;n++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[n]=Math.floor(Ls(t[n]/255)*255):t[n]=Ls(t[n]);return{data:t,width:e.width,height:e.height}}else return Ye("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),e}},cx=0,Ao=class{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:cx++}),this.uuid=Vo(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){let t=this.data;return typeof HTMLVideoElement<"u"&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<"u"&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t!==null?e.set(t.width||0,t.height||0,t.depth||0):e.set(0,0,0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(gd(s[o].image)):r.push(gd(s[o]))}else r=gd(s);n.url=r}return t||(e.images[this.uuid]=n),n}};function gd(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?Dc.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(Ye("Texture: Unable to serialize Texture."),{})}var hx=0,yd=new W,hi=class i extends Ki{constructor(e=i.DEFAULT_IMAGE,t=i.DEFAULT_MAPPING,n=ms,s=ms,r=ri,o=ks,a=ts,l=ui,c=i.DEFAULT_ANISOTROPY,h=zs){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:hx++}),this.uuid=Vo(),this.name="",this.source=new Ao(e),this.mipmaps=[],this.mapping=t,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new Ze(0,0),this.repeat=new Ze(1,1),this.center=new Ze(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new st,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(e&&e.depth&&e.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(yd).x}get height(){return this.source.getSize(yd).y}get depth(){return this.source.getSize(yd).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(let t in e){let n=e[t];if(n===void 0){Ye(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}let s=this[t];if(s===void 0){Ye(`Texture.setValues(): property '${t}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),t||(e.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(e){if(this.mapping!==sf)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case Ic:e.x=e.x-Math.floor(e.x);break;case ms:e.x=e.x<0?0:1;break;case Lc:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x=e.x-Math.floor(e.x);break}if(e.y<0||e.y>1)switch(this.wrapT){case Ic:e.y=e.y-Math.floor(e.y);break;case ms:e.y=e.y<0?0:1;break;case Lc:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y=e.y-Math.floor(e.y);break}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}};hi.DEFAULT_IMAGE=null;hi.DEFAULT_MAPPING=sf;hi.DEFAULT_ANISOTROPY=1;var tn=class{static{this.prototype.isVector4=!0}constructor(e=0,t=0,n=0,s=1){this.x=e,this.y=t,this.z=n,this.w=s}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,n,s){return this.x=e,this.y=t,this.z=n,this.w=s,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw new Error("THREE.Vector4: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w!==void 0?e.w:1,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){let t=this.x,n=this.y,s=this.z,r=this.w,o=e.elements;return this.x=o[0]*t+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*t+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*t+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*t+o[7]*n+o[11]*s+o[15]*r,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);let t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,n,s,r,l=e.elements,c=l[0],h=l[4],d=l[8],u=l[1],f=l[5],g=l[9],y=l[2],p=l[6],m=l[10];if(Math.abs(h-u)<.01&&Math.abs(d-y)<.01&&Math.abs(g-p)<.01){if(Math.abs(h+u)<.1&&Math.abs(d+y)<.1&&Math.abs(g+p)<.1&&Math.abs(c+f+m-3)<.1)return this.set(1,0,0,0),this;t=Math.PI;let A=(c+1)/2,S=(f+1)/2,R=(m+1)/2,M=(h+u)/4,_=(d+y)/4,E=(g+p)/4;return A>S&&A>R?A<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(A),s=M/n,r=_/n):S>R?S<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(S),n=M/s,r=E/s):R<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(R),n=_/r,s=E/r),this.set(n,s,r,t),this}let x=Math.sqrt((p-g)*(p-g)+(d-y)*(d-y)+(u-h)*(u-h));return Math.abs(x)<.001&&(x=1),this.x=(p-g)/x,this.y=(d-y)/x,this.z=(u-h)/x,this.w=Math.acos((c+f+m-1)/2),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this.z=gt(this.z,e.z,t.z),this.w=gt(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this.z=gt(this.z,e,t),this.w=gt(this.w,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this.w=e.w+(t.w-e.w)*n,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Fc=class extends Ki{constructor(e=1,t=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:ri,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=e,this.height=t,this.depth=n.depth,this.scissor=new tn(0,0,e,t),this.scissorTest=!1,this.viewport=new tn(0,0,e,t),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new hi({width:e,height:t,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(e={}){let t={minFilter:ri,generateMipmaps:!1,flipY:!1,internalFormat:null};e.mapping!==void 0&&(t.mapping=e.mapping),e.wrapS!==void 0&&(t.wrapS=e.wrapS),e.wrapT!==void 0&&(t.wrapT=e.wrapT),e.wrapR!==void 0&&(t.wrapR=e.wrapR),e.magFilter!==void 0&&(t.magFilter=e.magFilter),e.minFilter!==void 0&&(t.minFilter=e.minFilter),e.format!==void 0&&(t.format=e.format),e.type!==void 0&&(t.type=e.type),e.anisotropy!==void 0&&(t.anisotropy=e.anisotropy),e.colorSpace!==void 0&&(t.colorSpace=e.colorSpace),e.flipY!==void 0&&(t.flipY=e.flipY),e.generateMipmaps!==void 0&&(t.generateMipmaps=e.generateMipmaps),e.mipmapsAutoUpdate!==void 0&&(t.mipmapsAutoUpdate=e.mipmapsAutoUpdate),e.internalFormat!==void 0&&(t.internalFormat=e.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(t)}get texture(){return this.textures[0]}set texture(e){this.textures[0]=e}set depthTexture(e){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),e!==null&&e.renderTarget===null&&(e.renderTarget=this),this._depthTexture=e}get depthTexture(){return this._depthTexture}setSize(e,t,n=1){if(this.width!==e||this.height!==t||this.depth!==n){this.width=e,this.height=t,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=e,this.textures[s].image.height=t,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,e,t),this.scissor.set(0,0,e,t)}clone(){return new this.constructor().copy(this)}copy(e){this.width=e.width,this.height=e.height,this.depth=e.depth,this.scissor.copy(e.scissor),this.scissorTest=e.scissorTest,this.viewport.copy(e.viewport),this.textures.length=0;for(let t=0,n=e.textures.length;t<n;t++){this.textures[t]=e.textures[t].clone(),this.textures[t].isRenderTargetTexture=!0,this.textures[t].renderTarget=this;let s=Object.assign({},e.textures[t].image);this.textures[t].source=new Ao(s)}if(this.depthBuffer=e.depthBuffer,this.stencilBuffer=e.stencilBuffer,this.resolveColorBuffer=e.resolveColorBuffer,this.resolveDepthBuffer=e.resolveDepthBuffer,this.resolveStencilBuffer=e.resolveStencilBuffer,this.storeMultisampledColorBuffer=e.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=e.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=e.storeMultisampledStencilBuffer,e.depthTexture!==null)if(e.depthTexture.renderTarget===e){let t=e.depthTexture.clone();t.renderTarget=null,this.depthTexture=t}else this.depthTexture=e.depthTexture;else this.depthTexture=null;return this.samples=e.samples,this.multiview=e.multiview,this.useArrayDepthTexture=e.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},Si=class extends Fc{constructor(e=1,t=1,n={}){super(e,t,n),this.isWebGLRenderTarget=!0}},La=class extends hi{constructor(e=null,t=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:e,width:t,height:n,depth:s},this.magFilter=zn,this.minFilter=zn,this.wrapR=ms,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}addLayerUpdate(e){this.layerUpdates.add(e)}clearLayerUpdates(){this.layerUpdates.clear()}};var Uc=class extends hi{constructor(e=null,t=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:e,width:t,height:n,depth:s},this.magFilter=zn,this.minFilter=zn,this.wrapR=ms,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}};var Mt=class i{static{this.prototype.isMatrix4=!0}constructor(e,t,n,s,r,o,a,l,c,h,d,u,f,g,y,p){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,n,s,r,o,a,l,c,h,d,u,f,g,y,p)}set(e,t,n,s,r,o,a,l,c,h,d,u,f,g,y,p){let m=this.elements;return m[0]=e,m[4]=t,m[8]=n,m[12]=s,m[1]=r,m[5]=o,m[9]=a,m[13]=l,m[2]=c,m[6]=h,m[10]=d,m[14]=u,m[3]=f,m[7]=g,m[11]=y,m[15]=p,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],t[9]=n[9],t[10]=n[10],t[11]=n[11],t[12]=n[12],t[13]=n[13],t[14]=n[14],t[15]=n[15],this}copyPosition(e){let t=this.elements,n=e.elements;return t[12]=n[12],t[13]=n[13],t[14]=n[14],this}setFromMatrix3(e){let t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,n){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),n.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(e,t,n){return this.set(e.x,t.x,n.x,0,e.y,t.y,n.y,0,e.z,t.z,n.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();let t=this.elements,n=e.elements,s=1/lo.setFromMatrixColumn(e,0).length(),r=1/lo.setFromMatrixColumn(e,1).length(),o=1/lo.setFromMatrixColumn(e,2).length();return t[0]=n[0]*s,t[1]=n[1]*s,t[2]=n[2]*s,t[3]=0,t[4]=n[4]*r,t[5]=n[5]*r,t[6]=n[6]*r,t[7]=0,t[8]=n[8]*o,t[9]=n[9]*o,t[10]=n[10]*o,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){let t=this.elements,n=e.x,s=e.y,r=e.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),d=Math.sin(r);if(e.order==="XYZ"){let u=o*h,f=o*d,g=a*h,y=a*d;t[0]=l*h,t[4]=-l*d,t[8]=c,t[1]=f+g*c,t[5]=u-y*c,t[9]=-a*l,t[2]=y-u*c,t[6]=g+f*c,t[10]=o*l}else if(e.order==="YXZ"){let u=l*h,f=l*d,g=c*h,y=c*d;t[0]=u+y*a,t[4]=g*a-f,t[8]=o*c,t[1]=o*d,t[5]=o*h,t[9]=-a,t[2]=f*a-g,t[6]=y+u*a,t[10]=o*l}else if(e.order==="ZXY"){let u=l*h,f=l*d,g=c*h,y=c*d;t[0]=u-y*a,t[4]=-o*d,t[8]=g+f*a,t[1]=f+g*a,t[5]=o*h,t[9]=y-u*a,t[2]=-o*c,t[6]=a,t[10]=o*l}else if(e.order==="ZYX"){let u=o*h,f=o*d,g=a*h,y=a*d;t[0]=l*h,t[4]=g*c-f,t[8]=u*c+y,t[1]=l*d,t[5]=y*c+u,t[9]=f*c-g,t[2]=-c,t[6]=a*l,t[10]=o*l}else if(e.order==="YZX"){let u=o*l,f=o*c,g=a*l,y=a*c;t[0]=l*h,t[4]=y-u*d,t[8]=g*d+f,t[1]=d,t[5]=o*h,t[9]=-a*h,t[2]=-c*h,t[6]=f*d+g,t[10]=u-y*d}else if(e.order==="XZY"){let u=o*l,f=o*c,g=a*l,y=a*c;t[0]=l*h,t[4]=-d,t[8]=c*h,t[1]=u*d+y,t[5]=o*h,t[9]=f*d-g,t[2]=g*d-f,t[6]=a*h,t[10]=y*d+u}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(ux,e,dx)}lookAt(e,t,n){let s=this.elements;return vi.subVectors(e,t),vi.lengthSq()===0&&(vi.z=1),vi.normalize(),Qs.crossVectors(n,vi),Qs.lengthSq()===0&&(Math.abs(n.z)===1?vi.x+=1e-4:vi.z+=1e-4,vi.normalize(),Qs.crossVectors(n,vi)),Qs.normalize(),Jl.crossVectors(vi,Qs),s[0]=Qs.x,s[4]=Jl.x,s[8]=vi.x,s[1]=Qs.y,s[5]=Jl.y,s[9]=vi.y,s[2]=Qs.z,s[6]=Jl.z,s[10]=vi.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,s=t.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],d=n[5],u=n[9],f=n[13],g=n[2],y=n[6],p=n[10],m=n[14],x=n[3],A=n[7],S=n[11],R=n[15],M=s[0],_=s[4],E=s[8],k=s[12],N=s[1],L=s[5],B=s[9],V=s[13],P=s[2],F=s[6],X=s[10],G=s[14],oe=s[3],$=s[7],J=s[11],ne=s[15];return r[0]=o*M+a*N+l*P+c*oe,r[4]=o*_+a*L+l*F+c*$,r[8]=o*E+a*B+l*X+c*J,r[12]=o*k+a*V+l*G+c*ne,r[1]=h*M+d*N+u*P+f*oe,r[5]=h*_+d*L+u*F+f*$,r[9]=h*E+d*B+u*X+f*J,r[13]=h*k+d*V+u*G+f*ne,r[2]=g*M+y*N+p*P+m*oe,r[6]=g*_+y*L+p*F+m*$,r[10]=g*E+y*B+p*X+m*J,r[14]=g*k+y*V+p*G+m*ne,r[3]=x*M+A*N+S*P+R*oe,r[7]=x*_+A*L+S*F+R*$,r[11]=x*E+A*B+S*X+R*J,r[15]=x*k+A*V+S*G+R*ne,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[4],s=e[8],r=e[12],o=e[1],a=e[5],l=e[9],c=e[13],h=e[2],d=e[6],u=e[10],f=e[14],g=e[3],y=e[7],p=e[11],m=e[15],x=l*f-c*u,A=a*f-c*d,S=a*u-l*d,R=o*f-c*h,M=o*u-l*h,_=o*d-a*h;return t*(y*x-p*A+m*S)-n*(g*x-p*R+m*M)+s*(g*A-y*R+m*_)-r*(g*S-y*M+p*_)}determinantAffine(){let e=this.elements,t=e[0],n=e[4],s=e[8],r=e[1],o=e[5],a=e[9],l=e[2],c=e[6],h=e[10];return t*(o*h-a*c)-n*(r*h-a*l)+s*(r*c-o*l)}transpose(){let e=this.elements,t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,n){let s=this.elements;return e.isVector3?(s[12]=e.x,s[13]=e.y,s[14]=e.z):(s[12]=e,s[13]=t,s[14]=n),this}invert(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],d=e[9],u=e[10],f=e[11],g=e[12],y=e[13],p=e[14],m=e[15],x=t*a-n*o,A=t*l-s*o,S=t*c-r*o,R=n*l-s*a,M=n*c-r*a,_=s*c-r*l,E=h*y-d*g,k=h*p-u*g,N=h*m-f*g,L=d*p-u*y,B=d*m-f*y,V=u*m-f*p,P=x*V-A*B+S*L+R*N-M*k+_*E;if(P===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let F=1/P;return e[0]=(a*V-l*B+c*L)*F,e[1]=(s*B-n*V-r*L)*F,e[2]=(y*_-p*M+m*R)*F,e[3]=(u*M-d*_-f*R)*F,e[4]=(l*N-o*V-c*k)*F,e[5]=(t*V-s*N+r*k)*F,e[6]=(p*S-g*_-m*A)*F,e[7]=(h*_-u*S+f*A)*F,e[8]=(o*B-a*N+c*E)*F,e[9]=(n*N-t*B-r*E)*F,e[10]=(g*M-y*S+m*x)*F,e[11]=(d*S-h*M-f*x)*F,e[12]=(a*k-o*L-l*E)*F,e[13]=(t*L-n*k+s*E)*F,e[14]=(y*A-g*R-p*x)*F,e[15]=(h*R-d*A+u*x)*F,this}scale(e){let t=this.elements,n=e.x,s=e.y,r=e.z;return t[0]*=n,t[4]*=s,t[8]*=r,t[1]*=n,t[5]*=s,t[9]*=r,t[2]*=n,t[6]*=s,t[10]*=r,t[3]*=n,t[7]*=s,t[11]*=r,this}getMaxScaleOnAxis(){let e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],n=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],s=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,n,s))}makeTranslation(e,t,n){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,n,0,0,0,1),this}makeRotationX(e){let t=Math.cos(e),n=Math.sin(e);return this.set(1,0,0,0,0,t,-n,0,0,n,t,0,0,0,0,1),this}makeRotationY(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,0,n,0,0,1,0,0,-n,0,t,0,0,0,0,1),this}makeRotationZ(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,0,n,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){let n=Math.cos(t),s=Math.sin(t),r=1-n,o=e.x,a=e.y,l=e.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(e,t,n){return this.set(e,0,0,0,0,t,0,0,0,0,n,0,0,0,0,1),this}makeShear(e,t,n,s,r,o){return this.set(1,n,r,0,e,1,o,0,t,s,1,0,0,0,0,1),this}compose(e,t,n){let s=this.elements,r=t._x,o=t._y,a=t._z,l=t._w,c=r+r,h=o+o,d=a+a,u=r*c,f=r*h,g=r*d,y=o*h,p=o*d,m=a*d,x=l*c,A=l*h,S=l*d,R=n.x,M=n.y,_=n.z;return s[0]=(1-(y+m))*R,s[1]=(f+S)*R,s[2]=(g-A)*R,s[3]=0,s[4]=(f-S)*M,s[5]=(1-(u+m))*M,s[6]=(p+x)*M,s[7]=0,s[8]=(g+A)*_,s[9]=(p-x)*_,s[10]=(1-(u+y))*_,s[11]=0,s[12]=e.x,s[13]=e.y,s[14]=e.z,s[15]=1,this}decompose(e,t,n){let s=this.elements;e.x=s[12],e.y=s[13],e.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),t.identity(),this;let o=lo.set(s[0],s[1],s[2]).length(),a=lo.set(s[4],s[5],s[6]).length(),l=lo.set(s[8],s[9],s[10]).length();r<0&&(o=-o),$i.copy(this);let c=1/o,h=1/a,d=1/l;return $i.elements[0]*=c,$i.elements[1]*=c,$i.elements[2]*=c,$i.elements[4]*=h,$i.elements[5]*=h,$i.elements[6]*=h,$i.elements[8]*=d,$i.elements[9]*=d,$i.elements[10]*=d,t.setFromRotationMatrix($i),n.x=o,n.y=a,n.z=l,this}makePerspective(e,t,n,s,r,o,a=Di,l=!1){let c=this.elements,h=2*r/(t-e),d=2*r/(n-s),u=(t+e)/(t-e),f=(n+s)/(n-s),g,y;if(l)g=r/(o-r),y=o*r/(o-r);else if(a===Di)g=-(o+r)/(o-r),y=-2*o*r/(o-r);else if(a===wo)g=-o/(o-r),y=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=u,c[12]=0,c[1]=0,c[5]=d,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=g,c[14]=y,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,n,s,r,o,a=Di,l=!1){let c=this.elements,h=2/(t-e),d=2/(n-s),u=-(t+e)/(t-e),f=-(n+s)/(n-s),g,y;if(l)g=1/(o-r),y=o/(o-r);else if(a===Di)g=-2/(o-r),y=-(o+r)/(o-r);else if(a===wo)g=-1/(o-r),y=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=u,c[1]=0,c[5]=d,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=g,c[14]=y,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){let t=this.elements,n=e.elements;for(let s=0;s<16;s++)if(t[s]!==n[s])return!1;return!0}fromArray(e,t=0){for(let n=0;n<16;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e[t+9]=n[9],e[t+10]=n[10],e[t+11]=n[11],e[t+12]=n[12],e[t+13]=n[13],e[t+14]=n[14],e[t+15]=n[15],e}},lo=new W,$i=new Mt,ux=new W(0,0,0),dx=new W(1,1,1),Qs=new W,Jl=new W,vi=new W,km=new Mt,Bm=new oi,Ds=class i{constructor(e=0,t=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=e,this._y=t,this._z=n,this._order=s}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,n,s=this._order){return this._x=e,this._y=t,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,n=!0){let s=e.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],d=s[2],u=s[6],f=s[10];switch(t){case"XYZ":this._y=Math.asin(gt(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,f),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(u,c),this._z=0);break;case"YXZ":this._x=Math.asin(-gt(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,f),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-d,r),this._z=0);break;case"ZXY":this._x=Math.asin(gt(u,-1,1)),Math.abs(u)<.9999999?(this._y=Math.atan2(-d,f),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-gt(d,-1,1)),Math.abs(d)<.9999999?(this._x=Math.atan2(u,f),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(gt(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-d,r)):(this._x=0,this._y=Math.atan2(a,f));break;case"XZY":this._z=Math.asin(-gt(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(u,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,f),this._y=0);break;default:Ye("Euler: .setFromRotationMatrix() encountered an unknown order: "+t)}return this._order=t,n===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,n){return km.makeRotationFromQuaternion(e),this.setFromRotationMatrix(km,t,n)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return Bm.setFromEuler(this),this.setFromQuaternion(Bm,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};Ds.DEFAULT_ORDER="XYZ";var Ro=class{constructor(){this.mask=1}set(e){this.mask=(1<<e|0)>>>0}enable(e){this.mask|=1<<e|0}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e|0}disable(e){this.mask&=~(1<<e|0)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return(this.mask&(1<<e|0))!==0}},fx=0,zm=new W,co=new oi,As=new Mt,jl=new W,_a=new W,px=new W,mx=new oi,Vm=new W(1,0,0),Gm=new W(0,1,0),Hm=new W(0,0,1),Wm={type:"added"},gx={type:"removed"},ho={type:"childadded",child:null},_d={type:"childremoved",child:null},Vn=class i extends Ki{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:fx++}),this.uuid=Vo(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let e=new W,t=new Ds,n=new oi,s=new W(1,1,1);function r(){n.setFromEuler(t,!1)}function o(){t.setFromQuaternion(n,void 0,!1)}t._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:e},rotation:{configurable:!0,enumerable:!0,value:t},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Mt},normalMatrix:{value:new st}}),this.matrix=new Mt,this.matrixWorld=new Mt,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Ro,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return co.setFromAxisAngle(e,t),this.quaternion.multiply(co),this}rotateOnWorldAxis(e,t){return co.setFromAxisAngle(e,t),this.quaternion.premultiply(co),this}rotateX(e){return this.rotateOnAxis(Vm,e)}rotateY(e){return this.rotateOnAxis(Gm,e)}rotateZ(e){return this.rotateOnAxis(Hm,e)}translateOnAxis(e,t){return zm.copy(e).applyQuaternion(this.quaternion),this.position.add(zm.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(Vm,e)}translateY(e){return this.translateOnAxis(Gm,e)}translateZ(e){return this.translateOnAxis(Hm,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(As.copy(this.matrixWorld).invert())}lookAt(e,t,n){e.isVector3?jl.copy(e):jl.set(e,t,n);let s=this.parent;this.updateWorldMatrix(!0,!1),_a.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?As.lookAt(_a,jl,this.up):As.lookAt(jl,_a,this.up),this.quaternion.setFromRotationMatrix(As),s&&(As.extractRotation(s.matrixWorld),co.setFromRotationMatrix(As),this.quaternion.premultiply(co.invert()))}add(e){if(arguments.length>1){for(let t=0;t<arguments.length;t++)this.add(arguments[t]);return this}return e===this?(tt("Object3D.add: object can't be added as a child of itself.",e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(Wm),ho.child=e,this.dispatchEvent(ho),ho.child=null):tt("Object3D.add: object not an instance of THREE.Object3D.",e),this)}remove(e){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(gx),_d.child=e,this.dispatchEvent(_d),_d.child=null),this}removeFromParent(){let e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),As.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),As.multiply(e.parent.matrixWorld)),e.applyMatrix4(As),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(Wm),ho.child=e,this.dispatchEvent(ho),ho.child=null,this}getObjectById(e){return this.getObjectByProperty("id",e)}getObjectByName(e){return this.getObjectByProperty("name",e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(e,t);if(o!==void 0)return o}}getObjectsByProperty(e,t,n=[]){this[e]===t&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(e,t,n);return n}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(_a,e,px),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(_a,mx,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);let t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].traverseVisible(e)}traverseAncestors(e){let t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let e=this.pivot;if(e!==null){let t=e.x,n=e.y,s=e.z,r=this.matrix.elements;r[12]+=t-r[0]*t-r[4]*n-r[8]*s,r[13]+=n-r[1]*t-r[5]*n-r[9]*s,r[14]+=s-r[2]*t-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].updateMatrixWorld(e)}updateWorldMatrix(e,t,n=!1){let s=this.parent;if(e===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),t===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(e){let t=e===void 0||typeof e=="string",n={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(e),s.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(e)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(e.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let d=l[c];r(e.shapes,d)}else r(e.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(e.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(e.materials,this.material[l]));s.material=a}else s.material=r(e.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(e).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(e.animations,l))}}if(t){let a=o(e.geometries),l=o(e.materials),c=o(e.textures),h=o(e.images),d=o(e.shapes),u=o(e.skeletons),f=o(e.animations),g=o(e.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),d.length>0&&(n.shapes=d),u.length>0&&(n.skeletons=u),f.length>0&&(n.animations=f),g.length>0&&(n.nodes=g)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot!==null?e.pivot.clone():null,this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let n=0;n<e.children.length;n++){let s=e.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Vn.DEFAULT_UP=new W(0,1,0);Vn.DEFAULT_MATRIX_AUTO_UPDATE=!0;Vn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var hn=class extends Vn{constructor(){super(),this.isGroup=!0,this.type="Group"}},yx={type:"move"},Co=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new hn,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new hn,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new W,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new W),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new hn,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new W,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new W,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(e){return this._targetRay!==null&&this._targetRay.dispatchEvent(e),this._grip!==null&&this._grip.dispatchEvent(e),this._hand!==null&&this._hand.dispatchEvent(e),this}connect(e){if(e&&e.hand){let t=this._hand;if(t)for(let n of e.hand.values())this._getHandJoint(t,n)}return this.dispatchEvent({type:"connected",data:e}),this}disconnect(e){return this.dispatchEvent({type:"disconnected",data:e}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(e,t,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(e&&t.session.visibilityState!=="visible-blurred"){if(c&&e.hand){o=!0;for(let y of e.hand.values()){let p=t.getJointPose(y,n),m=this._getHandJoint(c,y);p!==null&&(m.matrix.fromArray(p.transform.matrix),m.matrix.decompose(m.position,m.quaternion,m.scale),m.matrixWorldNeedsUpdate=!0,m.jointRadius=p.radius),m.visible=p!==null}let h=c.joints["index-finger-tip"],d=c.joints["thumb-tip"],u=h.position.distanceTo(d.position),f=.02,g=.005;c.inputState.pinching&&u>f+g?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:e.handedness,target:this})):!c.inputState.pinching&&u<=f-g&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:e.handedness,target:this}))}else l!==null&&e.gripSpace&&(r=t.getPose(e.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:e,target:this})));a!==null&&(s=t.getPose(e.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(yx)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(e,t){if(e.joints[t.jointName]===void 0){let n=new hn;n.matrixAutoUpdate=!1,n.visible=!1,e.joints[t.jointName]=n,e.add(n)}return e.joints[t.jointName]}},jg={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},er={h:0,s:0,l:0},Ql={h:0,s:0,l:0};function vd(i,e,t){return t<0&&(t+=1),t>1&&(t-=1),t<1/6?i+(e-i)*6*t:t<1/2?e:t<2/3?i+(e-i)*6*(2/3-t):i}var it=class{constructor(e,t,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,n)}set(e,t,n){if(t===void 0&&n===void 0){let s=e;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(e,t,n);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=bi){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,vt.colorSpaceToWorking(this,t),this}setRGB(e,t,n,s=vt.workingColorSpace){return this.r=e,this.g=t,this.b=n,vt.colorSpaceToWorking(this,s),this}setHSL(e,t,n,s=vt.workingColorSpace){if(e=gf(e,1),t=gt(t,0,1),n=gt(n,0,1),t===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+t):n+t-n*t,o=2*n-r;this.r=vd(o,r,e+1/3),this.g=vd(o,r,e),this.b=vd(o,r,e-1/3)}return vt.colorSpaceToWorking(this,s),this}setStyle(e,t=bi){function n(r){r!==void 0&&parseFloat(r)<1&&Ye("Color: Alpha component of "+e+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(e)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,t);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,t);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,t);break;default:Ye("Color: Unknown color model "+e)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(e)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,t);if(o===6)return this.setHex(parseInt(r,16),t);Ye("Color: Invalid hex color "+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=bi){let n=jg[e.toLowerCase()];return n!==void 0?this.setHex(n,t):Ye("Color: Unknown color "+e),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=Ls(e.r),this.g=Ls(e.g),this.b=Ls(e.b),this}copyLinearToSRGB(e){return this.r=So(e.r),this.g=So(e.g),this.b=So(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=bi){return vt.workingToColorSpace(Zn.copy(this),e),Math.round(gt(Zn.r*255,0,255))*65536+Math.round(gt(Zn.g*255,0,255))*256+Math.round(gt(Zn.b*255,0,255))}getHexString(e=bi){return("000000"+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=vt.workingColorSpace){vt.workingToColorSpace(Zn.copy(this),t);let n=Zn.r,s=Zn.g,r=Zn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let d=o-a;switch(c=h<=.5?d/(o+a):d/(2-o-a),o){case n:l=(s-r)/d+(s<r?6:0);break;case s:l=(r-n)/d+2;break;case r:l=(n-s)/d+4;break}l/=6}return e.h=l,e.s=c,e.l=h,e}getRGB(e,t=vt.workingColorSpace){return vt.workingToColorSpace(Zn.copy(this),t),e.r=Zn.r,e.g=Zn.g,e.b=Zn.b,e}getStyle(e=bi){vt.workingToColorSpace(Zn.copy(this),e);let t=Zn.r,n=Zn.g,s=Zn.b;return e!==bi?`color(${e} ${t.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(t*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(e,t,n){return this.getHSL(er),this.setHSL(er.h+e,er.s+t,er.l+n)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,n){return this.r=e.r+(t.r-e.r)*n,this.g=e.g+(t.g-e.g)*n,this.b=e.b+(t.b-e.b)*n,this}lerpHSL(e,t){this.getHSL(er),e.getHSL(Ql);let n=Aa(er.h,Ql.h,t),s=Aa(er.s,Ql.s,t),r=Aa(er.l,Ql.l,t);return this.setHSL(n,s,r),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){let t=this.r,n=this.g,s=this.b,r=e.elements;return this.r=r[0]*t+r[3]*n+r[6]*s,this.g=r[1]*t+r[4]*n+r[7]*s,this.b=r[2]*t+r[5]*n+r[8]*s,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},Zn=new it;it.NAMES=jg;var Na=class extends Vn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Ds,this.environmentIntensity=1,this.environmentRotation=new Ds,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background!==null?e.background.clone():null,this.environment=e.environment!==null?e.environment.clone():null,this.fog=e.fog!==null?e.fog.clone():null,this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial!==null?e.overrideMaterial.clone():null,this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){let t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}},Yi=new W,Rs=new W,xd=new W,Cs=new W,uo=new W,fo=new W,Xm=new W,bd=new W,Sd=new W,Md=new W,wd=new tn,Td=new tn,Ed=new tn,sr=class i{constructor(e=new W,t=new W,n=new W){this.a=e,this.b=t,this.c=n}static getNormal(e,t,n,s){s.subVectors(n,t),Yi.subVectors(e,t),s.cross(Yi);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(e,t,n,s,r){Yi.subVectors(s,t),Rs.subVectors(n,t),xd.subVectors(e,t);let o=Yi.dot(Yi),a=Yi.dot(Rs),l=Yi.dot(xd),c=Rs.dot(Rs),h=Rs.dot(xd),d=o*c-a*a;if(d===0)return r.set(0,0,0),null;let u=1/d,f=(c*l-a*h)*u,g=(o*h-a*l)*u;return r.set(1-f-g,g,f)}static containsPoint(e,t,n,s){return this.getBarycoord(e,t,n,s,Cs)===null?!1:Cs.x>=0&&Cs.y>=0&&Cs.x+Cs.y<=1}static getInterpolation(e,t,n,s,r,o,a,l){return this.getBarycoord(e,t,n,s,Cs)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,Cs.x),l.addScaledVector(o,Cs.y),l.addScaledVector(a,Cs.z),l)}static getInterpolatedAttribute(e,t,n,s,r,o){return wd.setScalar(0),Td.setScalar(0),Ed.setScalar(0),wd.fromBufferAttribute(e,t),Td.fromBufferAttribute(e,n),Ed.fromBufferAttribute(e,s),o.setScalar(0),o.addScaledVector(wd,r.x),o.addScaledVector(Td,r.y),o.addScaledVector(Ed,r.z),o}static isFrontFacing(e,t,n,s){return Yi.subVectors(n,t),Rs.subVectors(e,t),Yi.cross(Rs).dot(s)<0}set(e,t,n){return this.a.copy(e),this.b.copy(t),this.c.copy(n),this}setFromPointsAndIndices(e,t,n,s){return this.a.copy(e[t]),this.b.copy(e[n]),this.c.copy(e[s]),this}setFromAttributeAndIndices(e,t,n,s){return this.a.fromBufferAttribute(e,t),this.b.fromBufferAttribute(e,n),this.c.fromBufferAttribute(e,s),this}clone(){return new this.constructor().copy(this)}copy(e){return this.a.copy(e.a),this.b.copy(e.b),this.c.copy(e.c),this}getArea(){return Yi.subVectors(this.c,this.b),Rs.subVectors(this.a,this.b),Yi.cross(Rs).length()*.5}getMidpoint(e){return e.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(e){return i.getNormal(this.a,this.b,this.c,e)}getPlane(e){return e.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(e,t){return i.getBarycoord(e,this.a,this.b,this.c,t)}getInterpolation(e,t,n,s,r){return i.getInterpolation(e,this.a,this.b,this.c,t,n,s,r)}containsPoint(e){return i.containsPoint(e,this.a,this.b,this.c)}isFrontFacing(e){return i.isFrontFacing(this.a,this.b,this.c,e)}intersectsBox(e){return e.intersectsTriangle(this)}closestPointToPoint(e,t){let n=this.a,s=this.b,r=this.c,o,a;uo.subVectors(s,n),fo.subVectors(r,n),bd.subVectors(e,n);let l=uo.dot(bd),c=fo.dot(bd);if(l<=0&&c<=0)return t.copy(n);Sd.subVectors(e,s);let h=uo.dot(Sd),d=fo.dot(Sd);if(h>=0&&d<=h)return t.copy(s);let u=l*d-h*c;if(u<=0&&l>=0&&h<=0&&l-h>0)return o=l/(l-h),t.copy(n).addScaledVector(uo,o);Md.subVectors(e,r);let f=uo.dot(Md),g=fo.dot(Md);if(g>=0&&f<=g)return t.copy(r);let y=f*c-l*g;if(y<=0&&c>=0&&g<=0)return a=c/(c-g),t.copy(n).addScaledVector(fo,a);let p=h*g-f*d;if(p<=0&&d-h>=0&&f-g>=0)return Xm.subVectors(r,s),a=(d-h)/(d-h+(f-g)),t.copy(s).addScaledVector(Xm,a);let m=1/(p+y+u);return o=y*m,a=u*m,t.copy(n).addScaledVector(uo,o).addScaledVector(fo,a)}equals(e){return e.a.equals(this.a)&&e.b.equals(this.b)&&e.c.equals(this.c)}},gs=class{constructor(e=new W(1/0,1/0,1/0),t=new W(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=e,this.max=t}set(e,t){return this.min.copy(e),this.max.copy(t),this}setFromArray(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t+=3)this.expandByPoint(Zi.fromArray(e,t));return this}setFromBufferAttribute(e){this.makeEmpty();for(let t=0,n=e.count;t<n;t++)this.expandByPoint(Zi.fromBufferAttribute(e,t));return this}setFromPoints(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t++)this.expandByPoint(e[t]);return this}setFromCenterAndSize(e,t){let n=Zi.copy(t).multiplyScalar(.5);return this.min.copy(e).sub(n),this.max.copy(e).add(n),this}setFromObject(e,t=!1){return this.makeEmpty(),this.expandByObject(e,t)}clone(){return new this.constructor().copy(this)}copy(e){return this.min.copy(e.min),this.max.copy(e.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(e){return this.isEmpty()?e.set(0,0,0):e.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(e){return this.isEmpty()?e.set(0,0,0):e.subVectors(this.max,this.min)}expandByPoint(e){return this.min.min(e),this.max.max(e),this}expandByVector(e){return this.min.sub(e),this.max.add(e),this}expandByScalar(e){return this.min.addScalar(-e),this.max.addScalar(e),this}expandByObject(e,t=!1){e.updateWorldMatrix(!1,!1);let n=e.geometry;if(n!==void 0){let r=n.getAttribute("position");if(t===!0&&r!==void 0&&e.isInstancedMesh!==!0&&e.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)e.isMesh===!0?e.getVertexPosition(o,Zi):Zi.fromBufferAttribute(r,o),Zi.applyMatrix4(e.matrixWorld),this.expandByPoint(Zi);else e.boundingBox!==void 0?(e.boundingBox===null&&e.computeBoundingBox(),ec.copy(e.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),ec.copy(n.boundingBox)),ec.applyMatrix4(e.matrixWorld),this.union(ec)}let s=e.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],t);return this}containsPoint(e){return e.x>=this.min.x&&e.x<=this.max.x&&e.y>=this.min.y&&e.y<=this.max.y&&e.z>=this.min.z&&e.z<=this.max.z}containsBox(e){return this.min.x<=e.min.x&&e.max.x<=this.max.x&&this.min.y<=e.min.y&&e.max.y<=this.max.y&&this.min.z<=e.min.z&&e.max.z<=this.max.z}getParameter(e,t){return t.set((e.x-this.min.x)/(this.max.x-this.min.x),(e.y-this.min.y)/(this.max.y-this.min.y),(e.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(e){return e.max.x>=this.min.x&&e.min.x<=this.max.x&&e.max.y>=this.min.y&&e.min.y<=this.max.y&&e.max.z>=this.min.z&&e.min.z<=this.max.z}intersectsSphere(e){return this.clampPoint(e.center,Zi),Zi.distanceToSquared(e.center)<=e.radius*e.radius}intersectsPlane(e){let t,n;return e.normal.x>0?(t=e.normal.x*this.min.x,n=e.normal.x*this.max.x):(t=e.normal.x*this.max.x,n=e.normal.x*this.min.x),e.normal.y>0?(t+=e.normal.y*this.min.y,n+=e.normal.y*this.max.y):(t+=e.normal.y*this.max.y,n+=e.normal.y*this.min.y),e.normal.z>0?(t+=e.normal.z*this.min.z,n+=e.normal.z*this.max.z):(t+=e.normal.z*this.max.z,n+=e.normal.z*this.min.z),t<=-e.constant&&n>=-e.constant}intersectsTriangle(e){if(this.isEmpty())return!1;this.getCenter(va),tc.subVectors(this.max,va),po.subVectors(e.a,va),mo.subVectors(e.b,va),go.subVectors(e.c,va),tr.subVectors(mo,po),nr.subVectors(go,mo),Tr.subVectors(po,go);let t=[0,-tr.z,tr.y,0,-nr.z,nr.y,0,-Tr.z,Tr.y,tr.z,0,-tr.x,nr.z,0,-nr.x,Tr.z,0,-Tr.x,-tr.y,tr.x,0,-nr.y,nr.x,0,-Tr.y,Tr.x,0];return!Ad(t,po,mo,go,tc)||(t=[1,0,0,0,1,0,0,0,1],!Ad(t,po,mo,go,tc))?!1:(nc.crossVectors(tr,nr),t=[nc.x,nc.y,nc.z],Ad(t,po,mo,go,tc))}clampPoint(e,t){return t.copy(e).clamp(this.min,this.max)}distanceToPoint(e){return this.clampPoint(e,Zi).distanceTo(e)}getBoundingSphere(e){return this.isEmpty()?e.makeEmpty():(this.getCenter(e.center),e.radius=this.getSize(Zi).length()*.5),e}intersect(e){return this.min.max(e.min),this.max.min(e.max),this.isEmpty()&&this.makeEmpty(),this}union(e){return this.min.min(e.min),this.max.max(e.max),this}applyMatrix4(e){return this.isEmpty()?this:(Ps[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(e),Ps[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(e),Ps[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(e),Ps[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(e),Ps[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(e),Ps[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(e),Ps[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(e),Ps[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(e),this.setFromPoints(Ps),this)}translate(e){return this.min.add(e),this.max.add(e),this}equals(e){return e.min.equals(this.min)&&e.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(e){return this.min.fromArray(e.min),this.max.fromArray(e.max),this}},Ps=[new W,new W,new W,new W,new W,new W,new W,new W],Zi=new W,ec=new gs,po=new W,mo=new W,go=new W,tr=new W,nr=new W,Tr=new W,va=new W,tc=new W,nc=new W,Er=new W;function Ad(i,e,t,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Er.fromArray(i,r);let a=s.x*Math.abs(Er.x)+s.y*Math.abs(Er.y)+s.z*Math.abs(Er.z),l=e.dot(Er),c=t.dot(Er),h=n.dot(Er);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var Sn=new W,ic=new Ze,_x=0,Ht=class extends Ki{constructor(e,t,n=!1){if(super(),Array.isArray(e))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:_x++}),this.name="",this.array=e,this.itemSize=t,this.count=e!==void 0?e.length/t:0,this.normalized=n,this.usage=Xg,this.updateRanges=[],this.gpuType=ki,this.version=0,this._normalizationScale=e!==void 0?_f(e):void 0}onUploadCallback(){}set needsUpdate(e){e===!0&&this.version++}setUsage(e){return this.usage=e,this}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}copy(e){return this.name=e.name,this.array=new e.array.constructor(e.array),this.itemSize=e.itemSize,this.count=e.count,this.normalized=e.normalized,this.usage=e.usage,this.gpuType=e.gpuType,this._normalizationScale=e._normalizationScale,this}copyAt(e,t,n){e*=this.itemSize,n*=t.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[e+s]=t.array[n+s];return this}copyArray(e){return this.array.set(e),this}applyMatrix3(e){if(this.itemSize===2)for(let t=0,n=this.count;t<n;t++)ic.fromBufferAttribute(this,t),ic.applyMatrix3(e),this.setXY(t,ic.x,ic.y);else if(this.itemSize===3)for(let t=0,n=this.count;t<n;t++)Sn.fromBufferAttribute(this,t),Sn.applyMatrix3(e),this.setXYZ(t,Sn.x,Sn.y,Sn.z);return this}applyMatrix4(e){for(let t=0,n=this.count;t<n;t++)Sn.fromBufferAttribute(this,t),Sn.applyMatrix4(e),this.setXYZ(t,Sn.x,Sn.y,Sn.z);return this}applyNormalMatrix(e){for(let t=0,n=this.count;t<n;t++)Sn.fromBufferAttribute(this,t),Sn.applyNormalMatrix(e),this.setXYZ(t,Sn.x,Sn.y,Sn.z);return this}transformDirection(e){for(let t=0,n=this.count;t<n;t++)Sn.fromBufferAttribute(this,t),Sn.transformDirection(e),this.setXYZ(t,Sn.x,Sn.y,Sn.z);return this}set(e,t=0){return this.array.set(e,t),this}getComponent(e,t){let n=this.array[e*this.itemSize+t];return this.normalized&&(n=this._denormalize(n)),n}setComponent(e,t,n){return this.normalized&&(n=this._normalize(n)),this.array[e*this.itemSize+t]=n,this}getX(e){let t=this.array[e*this.itemSize];return this.normalized&&(t=this._denormalize(t)),t}setX(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize]=t,this}getY(e){let t=this.array[e*this.itemSize+1];return this.normalized&&(t=this._denormalize(t)),t}setY(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+1]=t,this}getZ(e){let t=this.array[e*this.itemSize+2];return this.normalized&&(t=this._denormalize(t)),t}setZ(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+2]=t,this}getW(e){let t=this.array[e*this.itemSize+3];return this.normalized&&(t=this._denormalize(t)),t}setW(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+3]=t,this}setXY(e,t,n){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n)),this.array[e+0]=t,this.array[e+1]=n,this}setXYZ(e,t,n,s){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),s=this._normalize(s)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=s,this}setXYZW(e,t,n,s,r){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=s,this.array[e+3]=r,this}onUpload(e){return this.onUploadCallback=e,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let e={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return e.name=this.name,e.usage=this.usage,e.gpuType=this.gpuType,e}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(e){let t=this._normalizationScale;return t!==void 0?Math.max(e/t,-1):Kg(e,this.array)}_normalize(e){let t=this._normalizationScale;return t!==void 0?Math.round(e*t):Jg(e,this.array)}};var Da=class extends Ht{constructor(e,t,n){super(new Uint16Array(e),t,n)}};var Fa=class extends Ht{constructor(e,t,n){super(new Uint32Array(e),t,n)}};var Mn=class extends Ht{constructor(e,t,n){super(new Float32Array(e),t,n)}},vx=new gs,xa=new W,Rd=new W,Rn=class{constructor(e=new W,t=-1){this.isSphere=!0,this.center=e,this.radius=t}set(e,t){return this.center.copy(e),this.radius=t,this}setFromPoints(e,t){let n=this.center;t!==void 0?n.copy(t):vx.setFromPoints(e).getCenter(n);let s=0;for(let r=0,o=e.length;r<o;r++)s=Math.max(s,n.distanceToSquared(e[r]));return this.radius=Math.sqrt(s),this}copy(e){return this.center.copy(e.center),this.radius=e.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(e){return e.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(e){return e.distanceTo(this.center)-this.radius}intersectsSphere(e){let t=this.radius+e.radius;return e.center.distanceToSquared(this.center)<=t*t}intersectsBox(e){return e.intersectsSphere(this)}intersectsPlane(e){return Math.abs(e.distanceToPoint(this.center))<=this.radius}clampPoint(e,t){let n=this.center.distanceToSquared(e);return t.copy(e),n>this.radius*this.radius&&(t.sub(this.center).normalize(),t.multiplyScalar(this.radius).add(this.center)),t}getBoundingBox(e){return this.isEmpty()?(e.makeEmpty(),e):(e.set(this.center,this.center),e.expandByScalar(this.radius),e)}applyMatrix4(e){return this.center.applyMatrix4(e),this.radius=this.radius*e.getMaxScaleOnAxis(),this}translate(e){return this.center.add(e),this}expandByPoint(e){if(this.isEmpty())return this.center.copy(e),this.radius=0,this;xa.subVectors(e,this.center);let t=xa.lengthSq();if(t>this.radius*this.radius){let n=Math.sqrt(t),s=(n-this.radius)*.5;this.center.addScaledVector(xa,s/n),this.radius+=s}return this}union(e){return e.isEmpty()?this:this.isEmpty()?(this.copy(e),this):(this.center.equals(e.center)===!0?this.radius=Math.max(this.radius,e.radius):(Rd.subVectors(e.center,this.center).setLength(e.radius),this.expandByPoint(xa.copy(e.center).add(Rd)),this.expandByPoint(xa.copy(e.center).sub(Rd))),this)}equals(e){return e.center.equals(this.center)&&e.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(e){return this.radius=e.radius,this.center.fromArray(e.center),this}},xx=0,Ni=new Mt,Cd=new Vn,yo=new W,xi=new gs,ba=new gs,Bn=new W,nn=class i extends Ki{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:xx++}),this.uuid=Vo(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(e){return Array.isArray(e)?this.index=new(Xv(e)?Fa:Da)(e,1):this.index=e,this}setIndirect(e,t=0){return this.indirect=e,this.indirectOffset=t,this}getIndirect(){return this.indirect}getAttribute(e){return this.attributes[e]}setAttribute(e,t){return this.attributes[e]=t,this}deleteAttribute(e){return delete this.attributes[e],this}hasAttribute(e){return this.attributes[e]!==void 0}addGroup(e,t,n=0){this.groups.push({start:e,count:t,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(e,t){this.drawRange.start=e,this.drawRange.count=t}applyMatrix4(e){let t=this.attributes.position;t!==void 0&&(t.applyMatrix4(e),t.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new st().getNormalMatrix(e);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(e),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(e){return Ni.makeRotationFromQuaternion(e),this.applyMatrix4(Ni),this}rotateX(e){return Ni.makeRotationX(e),this.applyMatrix4(Ni),this}rotateY(e){return Ni.makeRotationY(e),this.applyMatrix4(Ni),this}rotateZ(e){return Ni.makeRotationZ(e),this.applyMatrix4(Ni),this}translate(e,t,n){return Ni.makeTranslation(e,t,n),this.applyMatrix4(Ni),this}scale(e,t,n){return Ni.makeScale(e,t,n),this.applyMatrix4(Ni),this}lookAt(e){return Cd.lookAt(e),Cd.updateMatrix(),this.applyMatrix4(Cd.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(yo).negate(),this.translate(yo.x,yo.y,yo.z),this}setFromPoints(e){let t=this.getAttribute("position");if(t===void 0){let n=[];for(let s=0,r=e.length;s<r;s++){let o=e[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Mn(n,3))}else{let n=Math.min(e.length,t.count);for(let s=0;s<n;s++){let r=e[s];t.setXYZ(s,r.x,r.y,r.z||0)}e.length>t.count&&Ye("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),t.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new gs);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){tt("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new W(-1/0,-1/0,-1/0),new W(1/0,1/0,1/0));return}if(e!==void 0){if(this.boundingBox.setFromBufferAttribute(e),t)for(let n=0,s=t.length;n<s;n++){let r=t[n];xi.setFromBufferAttribute(r),this.morphTargetsRelative?(Bn.addVectors(this.boundingBox.min,xi.min),this.boundingBox.expandByPoint(Bn),Bn.addVectors(this.boundingBox.max,xi.max),this.boundingBox.expandByPoint(Bn)):(this.boundingBox.expandByPoint(xi.min),this.boundingBox.expandByPoint(xi.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&tt('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new Rn);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){tt("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new W,1/0);return}if(e){let n=this.boundingSphere.center;if(xi.setFromBufferAttribute(e),t)for(let r=0,o=t.length;r<o;r++){let a=t[r];ba.setFromBufferAttribute(a),this.morphTargetsRelative?(Bn.addVectors(xi.min,ba.min),xi.expandByPoint(Bn),Bn.addVectors(xi.max,ba.max),xi.expandByPoint(Bn)):(xi.expandByPoint(ba.min),xi.expandByPoint(ba.max))}xi.getCenter(n);let s=0;for(let r=0,o=e.count;r<o;r++)Bn.fromBufferAttribute(e,r),s=Math.max(s,n.distanceToSquared(Bn));if(t)for(let r=0,o=t.length;r<o;r++){let a=t[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)Bn.fromBufferAttribute(a,c),l&&(yo.fromBufferAttribute(e,c),Bn.add(yo)),s=Math.max(s,n.distanceToSquared(Bn))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&tt('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let e=this.index,t=this.attributes;if(e===null||t.position===void 0||t.normal===void 0||t.uv===void 0){tt("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=t.position,s=t.normal,r=t.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ht(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let k=0;k<n.count;k++)a[k]=new W,l[k]=new W;let h=new W,d=new W,u=new W,f=new Ze,g=new Ze,y=new Ze,p=new W,m=new W;function x(k,N,L){c[k]=c[N]=c[L]=1,h.fromBufferAttribute(n,k),d.fromBufferAttribute(n,N),u.fromBufferAttribute(n,L),f.fromBufferAttribute(r,k),g.fromBufferAttribute(r,N),y.fromBufferAttribute(r,L),d.sub(h),u.sub(h),g.sub(f),y.sub(f);let B=1/(g.x*y.y-y.x*g.y);isFinite(B)&&(p.copy(d).multiplyScalar(y.y).addScaledVector(u,-g.y).multiplyScalar(B),m.copy(u).multiplyScalar(g.x).addScaledVector(d,-y.x).multiplyScalar(B),a[k].add(p),a[N].add(p),a[L].add(p),l[k].add(m),l[N].add(m),l[L].add(m))}let A=this.groups;A.length===0&&(A=[{start:0,count:e.count}]);for(let k=0,N=A.length;k<N;++k){let L=A[k],B=L.start,V=L.count;for(let P=B,F=B+V;P<F;P+=3)x(e.getX(P+0),e.getX(P+1),e.getX(P+2))}let S=new W,R=new W,M=new W,_=new W;function E(k){M.fromBufferAttribute(s,k),_.copy(M);let N=a[k];S.copy(N),S.sub(M.multiplyScalar(M.dot(N))).normalize(),R.crossVectors(_,N);let B=R.dot(l[k])<0?-1:1;o.setXYZW(k,S.x,S.y,S.z,B)}for(let k=0,N=n.count;k<N;++k)c[k]&&E(k);this._transformed=!0}computeVertexNormals(){let e=this.index,t=this.getAttribute("position");if(t!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==t.count)n=new Ht(new Float32Array(t.count*3),3),this.setAttribute("normal",n);else for(let u=0,f=n.count;u<f;u++)n.setXYZ(u,0,0,0);let s=new W,r=new W,o=new W,a=new W,l=new W,c=new W,h=new W,d=new W;if(e)for(let u=0,f=e.count;u<f;u+=3){let g=e.getX(u+0),y=e.getX(u+1),p=e.getX(u+2);s.fromBufferAttribute(t,g),r.fromBufferAttribute(t,y),o.fromBufferAttribute(t,p),h.subVectors(o,r),d.subVectors(s,r),h.cross(d),a.fromBufferAttribute(n,g),l.fromBufferAttribute(n,y),c.fromBufferAttribute(n,p),a.add(h),l.add(h),c.add(h),n.setXYZ(g,a.x,a.y,a.z),n.setXYZ(y,l.x,l.y,l.z),n.setXYZ(p,c.x,c.y,c.z)}else for(let u=0,f=t.count;u<f;u+=3)s.fromBufferAttribute(t,u+0),r.fromBufferAttribute(t,u+1),o.fromBufferAttribute(t,u+2),h.subVectors(o,r),d.subVectors(s,r),h.cross(d),n.setXYZ(u+0,h.x,h.y,h.z),n.setXYZ(u+1,h.x,h.y,h.z),n.setXYZ(u+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let e=this.attributes.normal;for(let t=0,n=e.count;t<n;t++)Bn.fromBufferAttribute(e,t),Bn.normalize(),e.setXYZ(t,Bn.x,Bn.y,Bn.z)}toNonIndexed(){function e(a,l){let c=a.array,h=a.itemSize,d=a.normalized,u=new c.constructor(l.length*h),f=0,g=0;for(let y=0,p=l.length;y<p;y++){a.isInterleavedBufferAttribute?f=l[y]*a.data.stride+a.offset:f=l[y]*h;for(let m=0;m<h;m++)u[g++]=c[f++]}return new Ht(u,h,d)}if(this.index===null)return Ye("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let t=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=e(l,n);t.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,d=c.length;h<d;h++){let u=c[h],f=e(u,n);l.push(f)}t.morphAttributes[a]=l}t.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];t.addGroup(c.start,c.count,c.materialIndex)}return t}toJSON(){let e={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(e.uuid=this.uuid,e.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,e.name=this.name,Object.keys(this.userData).length>0&&(e.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(e[c]=l[c]);return e}e.data={attributes:{}};let t=this.index;t!==null&&(e.data.index={type:t.array.constructor.name,array:Array.prototype.slice.call(t.array)});let n=this.attributes;for(let l in n){let c=n[l];e.data.attributes[l]=c.toJSON(e.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let d=0,u=c.length;d<u;d++){let f=c[d];h.push(f.toJSON(e.data))}h.length>0&&(s[l]=h,r=!0)}r&&(e.data.morphAttributes=s,e.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(e.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(e.data.boundingSphere=a.toJSON()),e}clone(){return new this.constructor().copy(this)}copy(e){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let t={};this.name=e.name;let n=e.index;n!==null&&this.setIndex(n.clone());let s=e.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(t))}let r=e.morphAttributes;for(let c in r){let h=[],d=r[c];for(let u=0,f=d.length;u<f;u++)h.push(d[u].clone(t));this.morphAttributes[c]=h}this.morphTargetsRelative=e.morphTargetsRelative;let o=e.groups;for(let c=0,h=o.length;c<h;c++){let d=o[c];this.addGroup(d.start,d.count,d.materialIndex)}let a=e.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=e.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=e.drawRange.start,this.drawRange.count=e.drawRange.count,this.userData=e.userData,this._transformed=e._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var Pd=new W,bx=new W,Sx=new st,ii=class{constructor(e=new W(1,0,0),t=0){this.isPlane=!0,this.normal=e,this.constant=t}set(e,t){return this.normal.copy(e),this.constant=t,this}setComponents(e,t,n,s){return this.normal.set(e,t,n),this.constant=s,this}setFromNormalAndCoplanarPoint(e,t){return this.normal.copy(e),this.constant=-t.dot(this.normal),this}setFromCoplanarPoints(e,t,n){let s=Pd.subVectors(n,t).cross(bx.subVectors(e,t)).normalize();return this.setFromNormalAndCoplanarPoint(s,e),this}copy(e){return this.normal.copy(e.normal),this.constant=e.constant,this}normalize(){let e=1/this.normal.length();return this.normal.multiplyScalar(e),this.constant*=e,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(e){return this.normal.dot(e)+this.constant}distanceToSphere(e){return this.distanceToPoint(e.center)-e.radius}projectPoint(e,t){return t.copy(e).addScaledVector(this.normal,-this.distanceToPoint(e))}intersectLine(e,t,n=!0){let s=e.delta(Pd),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(e.start)===0?t.copy(e.start):null;let o=-(e.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:t.copy(e.start).addScaledVector(s,o)}intersectsLine(e){let t=this.distanceToPoint(e.start),n=this.distanceToPoint(e.end);return t<0&&n>0||n<0&&t>0}intersectsBox(e){return e.intersectsPlane(this)}intersectsSphere(e){return e.intersectsPlane(this)}coplanarPoint(e){return e.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(e,t){let n=t||Sx.getNormalMatrix(e),s=this.coplanarPoint(Pd).applyMatrix4(e),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(e){return this.constant-=e.dot(this.normal),this}equals(e){return e.normal.equals(this.normal)&&e.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(e){return this.normal.fromArray(e.normal),this.constant=e.constant,this}},Mx=0,Ji=class extends Ki{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:Mx++}),this.uuid=Vo(),this.name="",this.type="Material",this.blending=ko,this.side=ur,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=Yd,this.blendDst=Zd,this.blendEquation=Dr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new it(0,0,0),this.blendAlpha=0,this.depthFunc=Mo,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=Bg,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Mc,this.stencilZFail=Mc,this.stencilZPass=Mc,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(e){this._alphaTest>0!=e>0&&this.version++,this._alphaTest=e}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(e){if(e!==void 0)for(let t in e){let n=e[t];if(n===void 0){Ye(`Material: parameter '${t}' has value of undefined.`);continue}let s=this[t];if(s===void 0){Ye(`Material: '${t}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e=="string";t&&(e={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(e).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(e).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(e).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(e).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(e).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(e).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(e).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(e).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(e).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(e).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(e).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(e).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(e).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(e).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(e).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(e).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(e).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(e).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(e).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(e).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(e).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(e).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(e).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(e).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(e).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(e).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(e).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(t){let r=s(e.textures),o=s(e.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(e,t){if(e.uuid!==void 0&&(this.uuid=e.uuid),e.name!==void 0&&(this.name=e.name),e.color!==void 0&&this.color!==void 0&&this.color.setHex(e.color),e.roughness!==void 0&&(this.roughness=e.roughness),e.metalness!==void 0&&(this.metalness=e.metalness),e.sheen!==void 0&&(this.sheen=e.sheen),e.sheenColor!==void 0&&(this.sheenColor=new it().setHex(e.sheenColor)),e.sheenRoughness!==void 0&&(this.sheenRoughness=e.sheenRoughness),e.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(e.emissive),e.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(e.specular),e.specularIntensity!==void 0&&(this.specularIntensity=e.specularIntensity),e.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(e.specularColor),e.shininess!==void 0&&(this.shininess=e.shininess),e.clearcoat!==void 0&&(this.clearcoat=e.clearcoat),e.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=e.clearcoatRoughness),e.diffuseRoughness!==void 0&&(this.diffuseRoughness=e.diffuseRoughness),e.dispersion!==void 0&&(this.dispersion=e.dispersion),e.retroreflectivity!==void 0&&(this.retroreflectivity=e.retroreflectivity),e.iridescence!==void 0&&(this.iridescence=e.iridescence),e.iridescenceIOR!==void 0&&(this.iridescenceIOR=e.iridescenceIOR),e.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessMinimum),e.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=e.iridescenceThicknessMaximum),e.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=e.iridescenceThicknessRange[1]),e.transmission!==void 0&&(this.transmission=e.transmission),e.thickness!==void 0&&(this.thickness=e.thickness),e.attenuationDistance!==void 0&&(this.attenuationDistance=e.attenuationDistance),e.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(e.attenuationColor),e.anisotropy!==void 0&&(this.anisotropy=e.anisotropy),e.anisotropyRotation!==void 0&&(this.anisotropyRotation=e.anisotropyRotation),e.fog!==void 0&&(this.fog=e.fog),e.flatShading!==void 0&&(this.flatShading=e.flatShading),e.blending!==void 0&&(this.blending=e.blending),e.combine!==void 0&&(this.combine=e.combine),e.side!==void 0&&(this.side=e.side),e.shadowSide!==void 0&&(this.shadowSide=e.shadowSide),e.opacity!==void 0&&(this.opacity=e.opacity),e.transparent!==void 0&&(this.transparent=e.transparent),e.alphaTest!==void 0&&(this.alphaTest=e.alphaTest),e.alphaHash!==void 0&&(this.alphaHash=e.alphaHash),e.depthFunc!==void 0&&(this.depthFunc=e.depthFunc),e.depthTest!==void 0&&(this.depthTest=e.depthTest),e.depthWrite!==void 0&&(this.depthWrite=e.depthWrite),e.colorWrite!==void 0&&(this.colorWrite=e.colorWrite),e.clippingPlanes!==void 0&&(this.clippingPlanes=e.clippingPlanes.map(n=>new ii().fromJSON(n))),e.clipIntersection!==void 0&&(this.clipIntersection=e.clipIntersection),e.clipShadows!==void 0&&(this.clipShadows=e.clipShadows),e.depthPacking!==void 0&&(this.depthPacking=e.depthPacking),e.blendSrc!==void 0&&(this.blendSrc=e.blendSrc),e.blendDst!==void 0&&(this.blendDst=e.blendDst),e.blendEquation!==void 0&&(this.blendEquation=e.blendEquation),e.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=e.blendSrcAlpha),e.blendDstAlpha!==void 0&&(this.blendDstAlpha=e.blendDstAlpha),e.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=e.blendEquationAlpha),e.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(e.blendColor),e.blendAlpha!==void 0&&(this.blendAlpha=e.blendAlpha),e.stencilWriteMask!==void 0&&(this.stencilWriteMask=e.stencilWriteMask),e.stencilFunc!==void 0&&(this.stencilFunc=e.stencilFunc),e.stencilRef!==void 0&&(this.stencilRef=e.stencilRef),e.stencilFuncMask!==void 0&&(this.stencilFuncMask=e.stencilFuncMask),e.stencilFail!==void 0&&(this.stencilFail=e.stencilFail),e.stencilZFail!==void 0&&(this.stencilZFail=e.stencilZFail),e.stencilZPass!==void 0&&(this.stencilZPass=e.stencilZPass),e.stencilWrite!==void 0&&(this.stencilWrite=e.stencilWrite),e.wireframe!==void 0&&(this.wireframe=e.wireframe),e.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=e.wireframeLinewidth),e.wireframeLinecap!==void 0&&(this.wireframeLinecap=e.wireframeLinecap),e.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=e.wireframeLinejoin),e.rotation!==void 0&&(this.rotation=e.rotation),e.linewidth!==void 0&&(this.linewidth=e.linewidth),e.linecap!==void 0&&(this.linecap=e.linecap),e.linejoin!==void 0&&(this.linejoin=e.linejoin),e.dashSize!==void 0&&(this.dashSize=e.dashSize),e.gapSize!==void 0&&(this.gapSize=e.gapSize),e.scale!==void 0&&(this.scale=e.scale),e.polygonOffset!==void 0&&(this.polygonOffset=e.polygonOffset),e.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=e.polygonOffsetFactor),e.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=e.polygonOffsetUnits),e.dithering!==void 0&&(this.dithering=e.dithering),e.alphaToCoverage!==void 0&&(this.alphaToCoverage=e.alphaToCoverage),e.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=e.premultipliedAlpha),e.forceSinglePass!==void 0&&(this.forceSinglePass=e.forceSinglePass),e.allowOverride!==void 0&&(this.allowOverride=e.allowOverride),e.visible!==void 0&&(this.visible=e.visible),e.toneMapped!==void 0&&(this.toneMapped=e.toneMapped),e.userData!==void 0&&(this.userData=e.userData),e.vertexColors!==void 0&&(typeof e.vertexColors=="number"?this.vertexColors=e.vertexColors>0:this.vertexColors=e.vertexColors),e.size!==void 0&&(this.size=e.size),e.sizeAttenuation!==void 0&&(this.sizeAttenuation=e.sizeAttenuation),e.map!==void 0&&(this.map=t[e.map]||null),e.matcap!==void 0&&(this.matcap=t[e.matcap]||null),e.alphaMap!==void 0&&(this.alphaMap=t[e.alphaMap]||null),e.bumpMap!==void 0&&(this.bumpMap=t[e.bumpMap]||null),e.bumpScale!==void 0&&(this.bumpScale=e.bumpScale),e.normalMap!==void 0&&(this.normalMap=t[e.normalMap]||null),e.normalMapType!==void 0&&(this.normalMapType=e.normalMapType),e.normalScale!==void 0){let n=e.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new Ze().fromArray(n)}return e.displacementMap!==void 0&&(this.displacementMap=t[e.displacementMap]||null),e.displacementScale!==void 0&&(this.displacementScale=e.displacementScale),e.displacementBias!==void 0&&(this.displacementBias=e.displacementBias),e.roughnessMap!==void 0&&(this.roughnessMap=t[e.roughnessMap]||null),e.metalnessMap!==void 0&&(this.metalnessMap=t[e.metalnessMap]||null),e.emissiveMap!==void 0&&(this.emissiveMap=t[e.emissiveMap]||null),e.emissiveIntensity!==void 0&&(this.emissiveIntensity=e.emissiveIntensity),e.specularMap!==void 0&&(this.specularMap=t[e.specularMap]||null),e.specularIntensityMap!==void 0&&(this.specularIntensityMap=t[e.specularIntensityMap]||null),e.specularColorMap!==void 0&&(this.specularColorMap=t[e.specularColorMap]||null),e.envMap!==void 0&&(this.envMap=t[e.envMap]||null),e.envMapRotation!==void 0&&this.envMapRotation.fromArray(e.envMapRotation),e.envMapIntensity!==void 0&&(this.envMapIntensity=e.envMapIntensity),e.reflectivity!==void 0&&(this.reflectivity=e.reflectivity),e.refractionRatio!==void 0&&(this.refractionRatio=e.refractionRatio),e.lightMap!==void 0&&(this.lightMap=t[e.lightMap]||null),e.lightMapIntensity!==void 0&&(this.lightMapIntensity=e.lightMapIntensity),e.aoMap!==void 0&&(this.aoMap=t[e.aoMap]||null),e.aoMapIntensity!==void 0&&(this.aoMapIntensity=e.aoMapIntensity),e.gradientMap!==void 0&&(this.gradientMap=t[e.gradientMap]||null),e.clearcoatMap!==void 0&&(this.clearcoatMap=t[e.clearcoatMap]||null),e.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=t[e.clearcoatRoughnessMap]||null),e.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=t[e.clearcoatNormalMap]||null),e.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new Ze().fromArray(e.clearcoatNormalScale)),e.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=t[e.diffuseRoughnessMap]||null),e.iridescenceMap!==void 0&&(this.iridescenceMap=t[e.iridescenceMap]||null),e.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=t[e.iridescenceThicknessMap]||null),e.transmissionMap!==void 0&&(this.transmissionMap=t[e.transmissionMap]||null),e.thicknessMap!==void 0&&(this.thicknessMap=t[e.thicknessMap]||null),e.anisotropyMap!==void 0&&(this.anisotropyMap=t[e.anisotropyMap]||null),e.sheenColorMap!==void 0&&(this.sheenColorMap=t[e.sheenColorMap]||null),e.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=t[e.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(e){this.name=e.name,this.blending=e.blending,this.side=e.side,this.vertexColors=e.vertexColors,this.opacity=e.opacity,this.transparent=e.transparent,this.blendSrc=e.blendSrc,this.blendDst=e.blendDst,this.blendEquation=e.blendEquation,this.blendSrcAlpha=e.blendSrcAlpha,this.blendDstAlpha=e.blendDstAlpha,this.blendEquationAlpha=e.blendEquationAlpha,this.blendColor.copy(e.blendColor),this.blendAlpha=e.blendAlpha,this.depthFunc=e.depthFunc,this.depthTest=e.depthTest,this.depthWrite=e.depthWrite,this.stencilWriteMask=e.stencilWriteMask,this.stencilFunc=e.stencilFunc,this.stencilRef=e.stencilRef,this.stencilFuncMask=e.stencilFuncMask,this.stencilFail=e.stencilFail,this.stencilZFail=e.stencilZFail,this.stencilZPass=e.stencilZPass,this.stencilWrite=e.stencilWrite;let t=e.clippingPlanes,n=null;if(t!==null){let s=t.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=t[r].clone()}return this.clippingPlanes=n,this.clipIntersection=e.clipIntersection,this.clipShadows=e.clipShadows,this.shadowSide=e.shadowSide,this.colorWrite=e.colorWrite,this.precision=e.precision,this.polygonOffset=e.polygonOffset,this.polygonOffsetFactor=e.polygonOffsetFactor,this.polygonOffsetUnits=e.polygonOffsetUnits,this.dithering=e.dithering,this.alphaTest=e.alphaTest,this.alphaHash=e.alphaHash,this.alphaToCoverage=e.alphaToCoverage,this.premultipliedAlpha=e.premultipliedAlpha,this.forceSinglePass=e.forceSinglePass,this.allowOverride=e.allowOverride,this.visible=e.visible,this.toneMapped=e.toneMapped,this.userData=JSON.parse(JSON.stringify(e.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(e){e===!0&&this.version++}};var Is=new W,Id=new W,sc=new W,rc=new W,Fs=class{constructor(e=new W,t=new W(0,0,-1)){this.origin=e,this.direction=t}set(e,t){return this.origin.copy(e),this.direction.copy(t),this}copy(e){return this.origin.copy(e.origin),this.direction.copy(e.direction),this}at(e,t){return t.copy(this.origin).addScaledVector(this.direction,e)}lookAt(e){return this.direction.copy(e).sub(this.origin).normalize(),this}recast(e){return this.origin.copy(this.at(e,Is)),this}closestPointToPoint(e,t){t.subVectors(e,this.origin);let n=t.dot(this.direction);return n<0?t.copy(this.origin):t.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(e){return Math.sqrt(this.distanceSqToPoint(e))}distanceSqToPoint(e){let t=Is.subVectors(e,this.origin).dot(this.direction);return t<0?this.origin.distanceToSquared(e):(Is.copy(this.origin).addScaledVector(this.direction,t),Is.distanceToSquared(e))}distanceSqToSegment(e,t,n,s){Id.copy(e).add(t).multiplyScalar(.5),sc.copy(t).sub(e).normalize(),rc.copy(this.origin).sub(Id);let r=e.distanceTo(t)*.5,o=-this.direction.dot(sc),a=rc.dot(this.direction),l=-rc.dot(sc),c=rc.lengthSq(),h=Math.abs(1-o*o),d,u,f,g;if(h>0)if(d=o*l-a,u=o*a-l,g=r*h,d>=0)if(u>=-g)if(u<=g){let y=1/h;d*=y,u*=y,f=d*(d+o*u+2*a)+u*(o*d+u+2*l)+c}else u=r,d=Math.max(0,-(o*u+a)),f=-d*d+u*(u+2*l)+c;else u=-r,d=Math.max(0,-(o*u+a)),f=-d*d+u*(u+2*l)+c;else u<=-g?(d=Math.max(0,-(-o*r+a)),u=d>0?-r:Math.min(Math.max(-r,-l),r),f=-d*d+u*(u+2*l)+c):u<=g?(d=0,u=Math.min(Math.max(-r,-l),r),f=u*(u+2*l)+c):(d=Math.max(0,-(o*r+a)),u=d>0?r:Math.min(Math.max(-r,-l),r),f=-d*d+u*(u+2*l)+c);else u=o>0?-r:r,d=Math.max(0,-(o*u+a)),f=-d*d+u*(u+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,d),s&&s.copy(Id).addScaledVector(sc,u),f}intersectSphere(e,t){if(e.radius<0)return null;Is.subVectors(e.center,this.origin);let n=Is.dot(this.direction),s=Is.dot(Is)-n*n,r=e.radius*e.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,t):this.at(a,t)}intersectsSphere(e){return e.radius<0?!1:this.distanceSqToPoint(e.center)<=e.radius*e.radius}distanceToPlane(e){let t=e.normal.dot(this.direction);if(t===0)return e.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(e.normal)+e.constant)/t;return n>=0?n:null}intersectPlane(e,t){let n=this.distanceToPlane(e);return n===null?null:this.at(n,t)}intersectsPlane(e){let t=e.distanceToPoint(this.origin);return t===0||e.normal.dot(this.direction)*t<0}intersectBox(e,t){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,d=1/this.direction.z,u=this.origin;return c>=0?(n=(e.min.x-u.x)*c,s=(e.max.x-u.x)*c):(n=(e.max.x-u.x)*c,s=(e.min.x-u.x)*c),h>=0?(r=(e.min.y-u.y)*h,o=(e.max.y-u.y)*h):(r=(e.max.y-u.y)*h,o=(e.min.y-u.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),d>=0?(a=(e.min.z-u.z)*d,l=(e.max.z-u.z)*d):(a=(e.max.z-u.z)*d,l=(e.min.z-u.z)*d),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,t)}intersectsBox(e){return this.intersectBox(e,Is)!==null}intersectTriangle(e,t,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,h=a.z,d=e.x-o.x,u=e.y-o.y,f=e.z-o.z,g=t.x-o.x,y=t.y-o.y,p=t.z-o.z,m=n.x-o.x,x=n.y-o.y,A=n.z-o.z,S=Math.abs(l),R=Math.abs(c),M=Math.abs(h),_,E,k,N,L,B,V,P,F,X,G,oe;if(S>=R&&S>=M?(k=l,B=d,F=g,oe=m,l>=0?(_=c,E=h,N=u,L=f,V=y,P=p,X=x,G=A):(_=h,E=c,N=f,L=u,V=p,P=y,X=A,G=x)):R>=M?(k=c,B=u,F=y,oe=x,c>=0?(_=h,E=l,N=f,L=d,V=p,P=g,X=A,G=m):(_=l,E=h,N=d,L=f,V=g,P=p,X=m,G=A)):(k=h,B=f,F=p,oe=A,h>=0?(_=l,E=c,N=d,L=u,V=g,P=y,X=m,G=x):(_=c,E=l,N=u,L=d,V=y,P=g,X=x,G=m)),k===0)return null;let $=_/k,J=E/k,ne=1/k,ue=N-$*B,ce=L-J*B,Q=V-$*F,pe=P-J*F,me=X-$*oe,ye=G-J*oe,ge=me*pe-ye*Q,Ve=ue*ye-ce*me,Je=Q*ce-pe*ue;if(s){if(ge<0||Ve<0||Je<0)return null}else if((ge<0||Ve<0||Je<0)&&(ge>0||Ve>0||Je>0))return null;let Ue=ge+Ve+Je;if(Ue===0)return null;let rt=ne*(ge*B+Ve*F+Je*oe);return(Ue>0?rt<0:rt>0)?null:this.at(rt/Ue,r)}applyMatrix4(e){return this.origin.applyMatrix4(e),this.direction.transformDirection(e),this}equals(e){return e.origin.equals(this.origin)&&e.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},rr=class extends Ji{constructor(e){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new it(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Ds,this.combine=th,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.fog=e.fog,this}},qm=new Mt,Ar=new Fs,oc=new Rn,$m=new W,ac=new W,lc=new W,cc=new W,Ld=new W,hc=new W,Ym=new W,uc=new W,Zt=class extends Vn{constructor(e=new nn,t=new rr){super(),this.isMesh=!0,this.type="Mesh",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}updateMorphTargets(){let t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){let s=t[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(e,t){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;t.fromBufferAttribute(s,e);let a=this.morphTargetInfluences;if(r&&a){hc.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],d=r[l];h!==0&&(Ld.fromBufferAttribute(d,e),o?hc.addScaledVector(Ld,h):hc.addScaledVector(Ld.sub(t),h))}t.add(hc)}return t}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),oc.copy(n.boundingSphere),oc.applyMatrix4(r),Ar.copy(e.ray).recast(e.near),!(oc.containsPoint(Ar.origin)===!1&&(Ar.intersectSphere(oc,$m)===null||Ar.origin.distanceToSquared($m)>(e.far-e.near)**2))&&(qm.copy(r).invert(),Ar.copy(e.ray).applyMatrix4(qm),!(n.boundingBox!==null&&Ar.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(e,t,Ar)))}_computeIntersections(e,t,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,d=r.attributes.normal,u=r.groups,f=r.drawRange;if(a!==null)if(Array.isArray(o))for(let g=0,y=u.length;g<y;g++){let p=u[g],m=o[p.materialIndex],x=Math.max(p.start,f.start),A=Math.min(a.count,Math.min(p.start+p.count,f.start+f.count));for(let S=x,R=A;S<R;S+=3){let M=a.getX(S),_=a.getX(S+1),E=a.getX(S+2);s=dc(this,m,e,n,c,h,d,M,_,E),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=p.materialIndex,t.push(s))}}else{let g=Math.max(0,f.start),y=Math.min(a.count,f.start+f.count);for(let p=g,m=y;p<m;p+=3){let x=a.getX(p),A=a.getX(p+1),S=a.getX(p+2);s=dc(this,o,e,n,c,h,d,x,A,S),s&&(s.faceIndex=Math.floor(p/3),t.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let g=0,y=u.length;g<y;g++){let p=u[g],m=o[p.materialIndex],x=Math.max(p.start,f.start),A=Math.min(l.count,Math.min(p.start+p.count,f.start+f.count));for(let S=x,R=A;S<R;S+=3){let M=S,_=S+1,E=S+2;s=dc(this,m,e,n,c,h,d,M,_,E),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=p.materialIndex,t.push(s))}}else{let g=Math.max(0,f.start),y=Math.min(l.count,f.start+f.count);for(let p=g,m=y;p<m;p+=3){let x=p,A=p+1,S=p+2;s=dc(this,o,e,n,c,h,d,x,A,S),s&&(s.faceIndex=Math.floor(p/3),t.push(s))}}}};function wx(i,e,t,n,s,r,o,a){let l;if(e.side===ai?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,e.side===ur,a),l===null)return null;uc.copy(a),uc.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(uc);return c<t.near||c>t.far?null:{distance:c,point:uc.clone(),object:i}}function dc(i,e,t,n,s,r,o,a,l,c){i.getVertexPosition(a,ac),i.getVertexPosition(l,lc),i.getVertexPosition(c,cc);let h=wx(i,e,t,n,ac,lc,cc,Ym);if(h){let d=new W;sr.getBarycoord(Ym,ac,lc,cc,d),s&&(h.uv=sr.getInterpolatedAttribute(s,a,l,c,d,new Ze)),r&&(h.uv1=sr.getInterpolatedAttribute(r,a,l,c,d,new Ze)),o&&(h.normal=sr.getInterpolatedAttribute(o,a,l,c,d,new W),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let u={a,b:l,c,normal:new W,materialIndex:0};sr.getNormal(ac,lc,cc,u.normal),h.face=u,h.barycoord=d}return h}var Ua=class extends hi{constructor(e=null,t=1,n=1,s,r,o,a,l,c=zn,h=zn,d,u){super(null,o,a,l,c,h,s,r,d,u),this.isDataTexture=!0,this.image={data:e,width:t,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var Oa=class extends Ht{constructor(e,t,n,s=1){super(e,t,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=s}copy(e){return super.copy(e),this.meshPerAttribute=e.meshPerAttribute,this}toJSON(){let e=super.toJSON();return e.meshPerAttribute=this.meshPerAttribute,e.isInstancedBufferAttribute=!0,e}},_o=new Mt,Zm=new Mt,fc=[],Km=new gs,Tx=new Mt,Sa=new Zt,Ma=new Rn,ka=class extends Zt{constructor(e,t,n){super(e,t),this.isInstancedMesh=!0,this.instanceMatrix=new Oa(new Float32Array(n*16),16),this.instanceColor=null,this.morphTexture=null,this.count=n,this.boundingBox=null,this.boundingSphere=null;for(let s=0;s<n;s++)this.setMatrixAt(s,Tx)}computeBoundingBox(){let e=this.geometry,t=this.count;this.boundingBox===null&&(this.boundingBox=new gs),e.boundingBox===null&&e.computeBoundingBox(),this.boundingBox.makeEmpty();for(let n=0;n<t;n++)this.getMatrixAt(n,_o),Km.copy(e.boundingBox).applyMatrix4(_o),this.boundingBox.union(Km)}computeBoundingSphere(){let e=this.geometry,t=this.count;this.boundingSphere===null&&(this.boundingSphere=new Rn),e.boundingSphere===null&&e.computeBoundingSphere(),this.boundingSphere.makeEmpty();for(let n=0;n<t;n++)this.getMatrixAt(n,_o),Ma.copy(e.boundingSphere).applyMatrix4(_o),this.boundingSphere.union(Ma)}copy(e,t){return super.copy(e,t),this.instanceMatrix.copy(e.instanceMatrix),this.morphTexture=e.morphTexture!==null?e.morphTexture.clone():null,this.instanceColor=e.instanceColor!==null?e.instanceColor.clone():null,this.count=e.count,this.boundingBox=e.boundingBox!==null?e.boundingBox.clone():null,this.boundingSphere=e.boundingSphere!==null?e.boundingSphere.clone():null,this}getColorAt(e,t){return this.instanceColor===null?t.setRGB(1,1,1):t.fromArray(this.instanceColor.array,e*3)}getMatrixAt(e,t){return t.fromArray(this.instanceMatrix.array,e*16)}getMorphAt(e,t){let n=t.morphTargetInfluences,s=this.morphTexture.source.data.data,r=n.length+1,o=e*r+1;for(let a=0;a<n.length;a++)n[a]=s[o+a]}raycast(e,t){let n=this.matrixWorld,s=this.count;if(Sa.geometry=this.geometry,Sa.material=this.material,Sa.material!==void 0&&(this.boundingSphere===null&&this.computeBoundingSphere(),Ma.copy(this.boundingSphere),Ma.applyMatrix4(n),e.ray.intersectsSphere(Ma)!==!1))for(let r=0;r<s;r++){this.getMatrixAt(r,_o),Zm.multiplyMatrices(n,_o),Sa.matrixWorld=Zm,Sa.raycast(e,fc);for(let o=0,a=fc.length;o<a;o++){let l=fc[o];l.instanceId=r,l.object=this,t.push(l)}fc.length=0}}setColorAt(e,t){return this.instanceColor===null&&(this.instanceColor=new Oa(new Float32Array(this.instanceMatrix.count*3).fill(1),3)),t.toArray(this.instanceColor.array,e*3),this}setMatrixAt(e,t){return t.toArray(this.instanceMatrix.array,e*16),this}setMorphAt(e,t){let n=t.morphTargetInfluences,s=n.length+1;this.morphTexture===null&&(this.morphTexture=new Ua(new Float32Array(s*this.count),s,this.count,lh,ki));let r=this.morphTexture.source.data.data,o=0;for(let c=0;c<n.length;c++)o+=n[c];let a=this.geometry.morphTargetsRelative?1:1-o,l=s*e;return r[l]=a,r.set(n,l+1),this}updateMorphTargets(){}dispose(){super.dispose(),this.instanceMatrix.dispose(),this.instanceColor!==null&&this.instanceColor.dispose(),this.morphTexture!==null&&(this.morphTexture.dispose(),this.morphTexture=null)}},Rr=new Rn,Ex=new Ze(.5,.5),pc=new W,or=class{constructor(e=new ii,t=new ii,n=new ii,s=new ii,r=new ii,o=new ii){this.planes=[e,t,n,s,r,o]}set(e,t,n,s,r,o){let a=this.planes;return a[0].copy(e),a[1].copy(t),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(e){let t=this.planes;for(let n=0;n<6;n++)t[n].copy(e.planes[n]);return this}setFromProjectionMatrix(e,t=Di,n=!1){let s=this.planes,r=e.elements,o=r[0],a=r[1],l=r[2],c=r[3],h=r[4],d=r[5],u=r[6],f=r[7],g=r[8],y=r[9],p=r[10],m=r[11],x=r[12],A=r[13],S=r[14],R=r[15];if(s[0].setComponents(c-o,f-h,m-g,R-x).normalize(),s[1].setComponents(c+o,f+h,m+g,R+x).normalize(),s[2].setComponents(c+a,f+d,m+y,R+A).normalize(),s[3].setComponents(c-a,f-d,m-y,R-A).normalize(),n)s[4].setComponents(l,u,p,S).normalize(),s[5].setComponents(c-l,f-u,m-p,R-S).normalize();else if(s[4].setComponents(c-l,f-u,m-p,R-S).normalize(),t===Di)s[5].setComponents(c+l,f+u,m+p,R+S).normalize();else if(t===wo)s[5].setComponents(l,u,p,S).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+t);return this}intersectsObject(e){if(e.boundingSphere!==void 0)e.boundingSphere===null&&e.computeBoundingSphere(),Rr.copy(e.boundingSphere).applyMatrix4(e.matrixWorld);else{let t=e.geometry;t.boundingSphere===null&&t.computeBoundingSphere(),Rr.copy(t.boundingSphere).applyMatrix4(e.matrixWorld)}return this.intersectsSphere(Rr)}intersectsSprite(e){Rr.center.set(0,0,0);let t=Ex.distanceTo(e.center);return Rr.radius=.7071067811865476+t,Rr.applyMatrix4(e.matrixWorld),this.intersectsSphere(Rr)}intersectsSphere(e){let t=this.planes,n=e.center,s=-e.radius;for(let r=0;r<6;r++)if(t[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(e){let t=this.planes;for(let n=0;n<6;n++){let s=t[n];if(pc.x=s.normal.x>0?e.max.x:e.min.x,pc.y=s.normal.y>0?e.max.y:e.min.y,pc.z=s.normal.z>0?e.max.z:e.min.z,s.distanceToPoint(pc)<0)return!1}return!0}containsPoint(e){let t=this.planes;for(let n=0;n<6;n++)if(t[n].distanceToPoint(e)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},Jm=new Mt,Oc=class i{constructor(){this.coordinateSystem=Di,this._frustums=[],this._count=0}setFromArrayCamera(e){let t=e.cameras,n=this._frustums;for(let s=0;s<t.length;s++){let r=t[s];Jm.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new or),n[s].setFromProjectionMatrix(Jm,r.coordinateSystem,r.reversedDepth)}return this._count=t.length,this}getFrustum(e){return this._frustums[e]}intersectsObject(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsObject(e))return!0;return!1}intersectsSprite(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSprite(e))return!0;return!1}intersectsSphere(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSphere(e))return!0;return!1}intersectsBox(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsBox(e))return!0;return!1}containsPoint(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].containsPoint(e))return!0;return!1}copy(e){this.coordinateSystem=e.coordinateSystem;let t=this._frustums,n=e._frustums;for(let s=0;s<e._count;s++)t[s]===void 0&&(t[s]=new or),t[s].copy(n[s]);return this._count=e._count,this}clone(){return new i().copy(this)}};var Mi=class extends Ji{constructor(e){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new it(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.linewidth=e.linewidth,this.linecap=e.linecap,this.linejoin=e.linejoin,this.fog=e.fog,this}},kc=new W,Bc=new W,jm=new Mt,wa=new Fs,mc=new Rn,Nd=new W,Qm=new W,Po=class extends Vn{constructor(e=new nn,t=new Mi){super(),this.isLine=!0,this.type="Line",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[0];for(let s=1,r=t.count;s<r;s++)kc.fromBufferAttribute(t,s-1),Bc.fromBufferAttribute(t,s),n[s]=n[s-1],n[s]+=kc.distanceTo(Bc);e.setAttribute("lineDistance",new Mn(n,1))}else Ye("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,s=this.matrixWorld,r=e.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),mc.copy(n.boundingSphere),mc.applyMatrix4(s),mc.radius+=r,e.ray.intersectsSphere(mc)===!1)return;jm.copy(s).invert(),wa.copy(e.ray).applyMatrix4(jm);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,u=n.attributes.position;if(h!==null){let f=Math.max(0,o.start),g=Math.min(h.count,o.start+o.count);for(let y=f,p=g-1;y<p;y+=c){let m=h.getX(y),x=h.getX(y+1),A=gc(this,e,wa,l,m,x,y);A&&t.push(A)}if(this.isLineLoop){let y=h.getX(g-1),p=h.getX(f),m=gc(this,e,wa,l,y,p,g-1);m&&t.push(m)}}else{let f=Math.max(0,o.start),g=Math.min(u.count,o.start+o.count);for(let y=f,p=g-1;y<p;y+=c){let m=gc(this,e,wa,l,y,y+1,y);m&&t.push(m)}if(this.isLineLoop){let y=gc(this,e,wa,l,g-1,f,g-1);y&&t.push(y)}}}updateMorphTargets(){let t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){let s=t[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function gc(i,e,t,n,s,r,o){let a=i.geometry.attributes.position;if(kc.fromBufferAttribute(a,s),Bc.fromBufferAttribute(a,r),t.distanceSqToSegment(kc,Bc,Nd,Qm)>n)return;Nd.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(Nd);if(!(c<e.near||c>e.far))return{distance:c,point:Qm.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var eg=new W,tg=new W,ys=class extends Po{constructor(e,t){super(e,t),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[];for(let s=0,r=t.count;s<r;s+=2)eg.fromBufferAttribute(t,s),tg.fromBufferAttribute(t,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+eg.distanceTo(tg);e.setAttribute("lineDistance",new Mn(n,1))}else Ye("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}};var ar=class extends Ji{constructor(e){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new it(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.alphaMap=e.alphaMap,this.size=e.size,this.sizeAttenuation=e.sizeAttenuation,this.fog=e.fog,this}},ng=new Mt,Bd=new Fs,yc=new Rn,_c=new W,Cr=class extends Vn{constructor(e=new nn,t=new ar){super(),this.isPoints=!0,this.type="Points",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,s=this.matrixWorld,r=e.params.Points.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),yc.copy(n.boundingSphere),yc.applyMatrix4(s),yc.radius+=r,e.ray.intersectsSphere(yc)===!1)return;ng.copy(s).invert(),Bd.copy(e.ray).applyMatrix4(ng);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=n.index,d=n.attributes.position;if(c!==null){let u=Math.max(0,o.start),f=Math.min(c.count,o.start+o.count);for(let g=u,y=f;g<y;g++){let p=c.getX(g);_c.fromBufferAttribute(d,p),ig(_c,p,l,s,e,t,this)}}else{let u=Math.max(0,o.start),f=Math.min(d.count,o.start+o.count);for(let g=u,y=f;g<y;g++)_c.fromBufferAttribute(d,g),ig(_c,g,l,s,e,t,this)}}updateMorphTargets(){let t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){let s=t[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function ig(i,e,t,n,s,r,o){let a=Bd.distanceSqToPoint(i);if(a<t){let l=new W;Bd.closestPointToPoint(i,l),l.applyMatrix4(n);let c=s.ray.origin.distanceTo(l);if(c<s.near||c>s.far)return;r.push({distance:c,distanceToRay:Math.sqrt(a),point:l,index:e,face:null,faceIndex:null,barycoord:null,object:o})}}var Ba=class extends hi{constructor(e=[],t=Fr,n,s,r,o,a,l,c,h){super(e,t,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(e){this.image=e}};var Us=class extends hi{constructor(e,t,n=Qi,s,r,o,a=zn,l=zn,c,h=Ns,d=1){if(h!==Ns&&h!==Bs)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let u={width:e,height:t,depth:d};super(u,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(e){return super.copy(e),this.source=new Ao(Object.assign({},e.image)),this.compareFunction=e.compareFunction,this}toJSON(e){let t=super.toJSON(e);return t.compareFunction=this.compareFunction,t}},za=class extends Us{constructor(e,t=Qi,n=Fr,s,r,o=zn,a=zn,l,c=Ns){let h={width:e,height:e,depth:1},d=[h,h,h,h,h,h];super(e,e,t,n,s,r,o,a,l,c),this.image=d,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(e){this.image=e}},Va=class extends hi{constructor(e=null){super(),this.sourceTexture=e,this.isExternalTexture=!0}copy(e){return super.copy(e),this.sourceTexture=e.sourceTexture,this}},Io=class i extends nn{constructor(e=1,t=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:e,height:t,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],d=[],u=0,f=0;g("z","y","x",-1,-1,n,t,e,o,r,0),g("z","y","x",1,-1,n,t,-e,o,r,1),g("x","z","y",1,1,e,n,t,s,o,2),g("x","z","y",1,-1,e,n,-t,s,o,3),g("x","y","z",1,-1,e,t,n,s,r,4),g("x","y","z",-1,-1,e,t,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Mn(c,3)),this.setAttribute("normal",new Mn(h,3)),this.setAttribute("uv",new Mn(d,2));function g(y,p,m,x,A,S,R,M,_,E,k){let N=S/_,L=R/E,B=S/2,V=R/2,P=M/2,F=_+1,X=E+1,G=0,oe=0,$=new W;for(let J=0;J<X;J++){let ne=J*L-V;for(let ue=0;ue<F;ue++){let ce=ue*N-B;$[y]=ce*x,$[p]=ne*A,$[m]=P,c.push($.x,$.y,$.z),$[y]=0,$[p]=0,$[m]=M>0?1:-1,h.push($.x,$.y,$.z),d.push(ue/_),d.push(1-J/E),G+=1}}for(let J=0;J<E;J++)for(let ne=0;ne<_;ne++){let ue=u+ne+F*J,ce=u+ne+F*(J+1),Q=u+(ne+1)+F*(J+1),pe=u+(ne+1)+F*J;l.push(ue,ce,pe),l.push(ce,Q,pe),oe+=6}a.addGroup(f,oe,k),f+=oe,u+=G}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.width,e.height,e.depth,e.widthSegments,e.heightSegments,e.depthSegments)}};var Lo=class i extends nn{constructor(e=1,t=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:e,radiusBottom:t,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let h=[],d=[],u=[],f=[],g=0,y=[],p=n/2,m=0;x(),o===!1&&(e>0&&A(!0),t>0&&A(!1)),this.setIndex(h),this.setAttribute("position",new Mn(d,3)),this.setAttribute("normal",new Mn(u,3)),this.setAttribute("uv",new Mn(f,2));function x(){let S=new W,R=new W,M=0,_=(t-e)/n;for(let E=0;E<=r;E++){let k=[],N=E/r,L=N*(t-e)+e;for(let B=0;B<=s;B++){let V=B/s,P=V*l+a,F=Math.sin(P),X=Math.cos(P);R.x=L*F,R.y=-N*n+p,R.z=L*X,d.push(R.x,R.y,R.z),S.set(F,_,X).normalize(),u.push(S.x,S.y,S.z),f.push(V,1-N),k.push(g++)}y.push(k)}for(let E=0;E<s;E++)for(let k=0;k<r;k++){let N=y[k][E],L=y[k+1][E],B=y[k+1][E+1],V=y[k][E+1];(e>0||k!==0)&&(h.push(N,L,V),M+=3),(t>0||k!==r-1)&&(h.push(L,B,V),M+=3)}c.addGroup(m,M,0),m+=M}function A(S){let R=g,M=new Ze,_=new W,E=0,k=S===!0?e:t,N=S===!0?1:-1;for(let B=1;B<=s;B++)d.push(0,p*N,0),u.push(0,N,0),f.push(.5,.5),g++;let L=g;for(let B=0;B<=s;B++){let P=B/s*l+a,F=Math.cos(P),X=Math.sin(P);_.x=k*X,_.y=p*N,_.z=k*F,d.push(_.x,_.y,_.z),u.push(0,N,0),M.x=F*.5+.5,M.y=X*.5*N+.5,f.push(M.x,M.y),g++}for(let B=0;B<s;B++){let V=R+B,P=L+B;S===!0?h.push(P,P+1,V):h.push(P+1,P,V),E+=3}c.addGroup(m,E,S===!0?1:2),m+=E}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radiusTop,e.radiusBottom,e.height,e.radialSegments,e.heightSegments,e.openEnded,e.thetaStart,e.thetaLength)}},Ga=class i extends Lo{constructor(e=1,t=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,e,t,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:e,height:t,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(e){return new i(e.radius,e.height,e.radialSegments,e.heightSegments,e.openEnded,e.thetaStart,e.thetaLength)}};var Pr=class i extends nn{constructor(e=1,t=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:e,height:t,widthSegments:n,heightSegments:s};let r=e/2,o=t/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,d=e/a,u=t/l,f=[],g=[],y=[],p=[];for(let m=0;m<h;m++){let x=m*u-o;for(let A=0;A<c;A++){let S=A*d-r;g.push(S,-x,0),y.push(0,0,1),p.push(A/a),p.push(1-m/l)}}for(let m=0;m<l;m++)for(let x=0;x<a;x++){let A=x+c*m,S=x+c*(m+1),R=x+1+c*(m+1),M=x+1+c*m;f.push(A,S,M),f.push(S,R,M)}this.setIndex(f),this.setAttribute("position",new Mn(g,3)),this.setAttribute("normal",new Mn(y,3)),this.setAttribute("uv",new Mn(p,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.width,e.height,e.widthSegments,e.heightSegments)}};var Ir=class i extends nn{constructor(e=1,t=32,n=16,s=0,r=Math.PI*2,o=0,a=Math.PI){super(),this.type="SphereGeometry",this.parameters={radius:e,widthSegments:t,heightSegments:n,phiStart:s,phiLength:r,thetaStart:o,thetaLength:a},t=Math.max(3,Math.floor(t)),n=Math.max(2,Math.floor(n));let l=Math.min(o+a,Math.PI),c=0,h=[],d=new W,u=new W,f=[],g=[],y=[],p=[];for(let m=0;m<=n;m++){let x=[],A=m/n,S=o+A*a,R=e*Math.cos(S),M=Math.sqrt(e*e-R*R),_=0;m===0&&o===0?_=.5/t:m===n&&l===Math.PI&&(_=-.5/t);for(let E=0;E<=t;E++){let k=E/t,N=s+k*r;d.x=-M*Math.cos(N),d.y=R,d.z=M*Math.sin(N),g.push(d.x,d.y,d.z),u.copy(d).normalize(),y.push(u.x,u.y,u.z),p.push(k+_,1-A),x.push(c++)}h.push(x)}for(let m=0;m<n;m++)for(let x=0;x<t;x++){let A=h[m][x+1],S=h[m][x],R=h[m+1][x],M=h[m+1][x+1];(m!==0||o>0)&&f.push(A,S,M),(m!==n-1||l<Math.PI)&&f.push(S,R,M)}this.setIndex(f),this.setAttribute("position",new Mn(g,3)),this.setAttribute("normal",new Mn(y,3)),this.setAttribute("uv",new Mn(p,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radius,e.widthSegments,e.heightSegments,e.phiStart,e.phiLength,e.thetaStart,e.thetaLength)}};var Ha=class extends Ji{constructor(e){super(),this.isShadowMaterial=!0,this.type="ShadowMaterial",this.color=new it(0),this.transparent=!0,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.fog=e.fog,this}};function Or(i){let e={};for(let t in i){e[t]={};for(let n in i[t]){let s=i[t][n];if(sg(s))s.isRenderTargetTexture?(Ye("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),e[t][n]=null):e[t][n]=s.clone();else if(Array.isArray(s))if(sg(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();e[t][n]=r}else e[t][n]=s.slice();else e[t][n]=s}}return e}function Jn(i){let e={};for(let t=0;t<i.length;t++){let n=Or(i[t]);for(let s in n)e[s]=n[s]}return e}function sg(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function Ax(i){let e=[];for(let t=0;t<i.length;t++)e.push(i[t].clone());return e}function xf(i){let e=i.getRenderTarget();return e===null?i.outputColorSpace:e.isXRRenderTarget===!0?e.texture.colorSpace:vt.workingColorSpace}var Qg={clone:Or,merge:Jn},Rx=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,Cx=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Fi=class extends Ji{constructor(e){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=Rx,this.fragmentShader=Cx,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,e!==void 0&&this.setValues(e)}copy(e){return super.copy(e),this.fragmentShader=e.fragmentShader,this.vertexShader=e.vertexShader,this.uniforms=Or(e.uniforms),this.uniformsGroups=Ax(e.uniformsGroups),this.defines=Object.assign({},e.defines),this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.fog=e.fog,this.lights=e.lights,this.clipping=e.clipping,this.extensions=Object.assign({},e.extensions),this.glslVersion=e.glslVersion,this.defaultAttributeValues=Object.assign({},e.defaultAttributeValues),this.index0AttributeName=e.index0AttributeName,this.uniformsNeedUpdate=e.uniformsNeedUpdate,this}toJSON(e){let t=super.toJSON(e);t.glslVersion=this.glslVersion,t.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?t.uniforms[s]={type:"t",value:o.toJSON(e).uuid}:o&&o.isColor?t.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?t.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?t.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?t.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?t.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?t.uniforms[s]={type:"m4",value:o.toArray()}:t.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(t.defines=this.defines),t.vertexShader=this.vertexShader,t.fragmentShader=this.fragmentShader,t.lights=this.lights,t.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(t.extensions=n),t}fromJSON(e,t){if(super.fromJSON(e,t),e.uniforms!==void 0)for(let n in e.uniforms){let s=e.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=t[s.value]||null;break;case"c":this.uniforms[n].value=new it().setHex(s.value);break;case"v2":this.uniforms[n].value=new Ze().fromArray(s.value);break;case"v3":this.uniforms[n].value=new W().fromArray(s.value);break;case"v4":this.uniforms[n].value=new tn().fromArray(s.value);break;case"m3":this.uniforms[n].value=new st().fromArray(s.value);break;case"m4":this.uniforms[n].value=new Mt().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(e.defines!==void 0&&(this.defines=e.defines),e.vertexShader!==void 0&&(this.vertexShader=e.vertexShader),e.fragmentShader!==void 0&&(this.fragmentShader=e.fragmentShader),e.glslVersion!==void 0&&(this.glslVersion=e.glslVersion),e.extensions!==void 0)for(let n in e.extensions)this.extensions[n]=e.extensions[n];return e.lights!==void 0&&(this.lights=e.lights),e.clipping!==void 0&&(this.clipping=e.clipping),this}},zc=class extends Fi{constructor(e){super(e),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}};var Os=class extends Ji{constructor(e){super(),this.isMeshPhongMaterial=!0,this.type="MeshPhongMaterial",this.color=new it(16777215),this.specular=new it(1118481),this.shininess=30,this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new it(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Gh,this.normalScale=new Ze(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Ds,this.combine=th,this.reflectivity=1,this.envMapIntensity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.specular.copy(e.specular),this.shininess=e.shininess,this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.emissive.copy(e.emissive),this.emissiveMap=e.emissiveMap,this.emissiveIntensity=e.emissiveIntensity,this.bumpMap=e.bumpMap,this.bumpScale=e.bumpScale,this.normalMap=e.normalMap,this.normalMapType=e.normalMapType,this.normalScale.copy(e.normalScale),this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.envMapIntensity=e.envMapIntensity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.flatShading=e.flatShading,this.fog=e.fog,this}};var Vc=class extends Ji{constructor(e){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=Og,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(e)}copy(e){return super.copy(e),this.depthPacking=e.depthPacking,this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this}},Gc=class extends Ji{constructor(e){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(e)}copy(e){return super.copy(e),this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this}};function vo(i,e){return!i||i.constructor===e?i:typeof e.BYTES_PER_ELEMENT=="number"?new e(i):Array.prototype.slice.call(i)}function vc(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var lr=class{constructor(e,t,n,s){this.parameterPositions=e,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new t.constructor(n),this.sampleValues=t,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(e){let t=this.parameterPositions,n=this._cachedIndex,s=t[n],r=t[n-1];n:{e:{let o;t:{i:if(!(e<s)){for(let a=n+2;;){if(s===void 0){if(e<r)break i;return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=t[++n],e<s)break e}o=t.length;break t}if(!(e>=r)){let a=t[1];e<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=t[--n-1],e>=r)break e}o=n,n=0;break t}break n}for(;n<o;){let a=n+o>>>1;e<t[a]?o=a:n=a+1}if(s=t[n],r=t[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,e,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(e){let t=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=e*s;for(let o=0;o!==s;++o)t[o]=n[r+o];return t}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Hc=class extends lr{constructor(e,t,n,s){super(e,t,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Ud,endingEnd:Ud}}intervalChanged_(e,t,n){let s=this.parameterPositions,r=e-2,o=e+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case Od:r=e,a=2*t-n;break;case kd:r=s.length-2,a=t+s[r]-s[r+1];break;default:r=e,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case Od:o=e,l=2*n-t;break;case kd:o=1,l=n+s[1]-s[0];break;default:o=e-1,l=t}let c=(n-t)*.5,h=this.valueSize;this._weightPrev=c/(t-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this._offsetPrev,d=this._offsetNext,u=this._weightPrev,f=this._weightNext,g=(n-t)/(s-t),y=g*g,p=y*g,m=-u*p+2*u*y-u*g,x=(1+u)*p+(-1.5-2*u)*y+(-.5+u)*g+1,A=(-1-f)*p+(1.5+f)*y+.5*g,S=f*p-f*y;for(let R=0;R!==a;++R)r[R]=m*o[h+R]+x*o[c+R]+A*o[l+R]+S*o[d+R];return r}},Wc=class extends lr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=(n-t)/(s-t),d=1-h;for(let u=0;u!==a;++u)r[u]=o[c+u]*d+o[l+u]*h;return r}},Xc=class extends lr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e){return this.copySampleValue_(e-1)}},qc=class extends lr{interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this.inTangents,d=this.outTangents;if(!h||!d){let g=(n-t)/(s-t),y=1-g;for(let p=0;p!==a;++p)r[p]=o[c+p]*y+o[l+p]*g;return r}let u=a*2,f=e-1;for(let g=0;g!==a;++g){let y=o[c+g],p=o[l+g],m=f*u+g*2,x=d[m],A=d[m+1],S=e*u+g*2,R=h[S],M=h[S+1],_=Ix(n,t,x,R,s);r[g]=e0(_,y,A,M,p)}return r}};function e0(i,e,t,n,s){let r=1-i;return r*r*r*e+3*r*r*i*t+3*r*i*i*n+i*i*i*s}function Px(i,e,t,n,s){let r=1-i;return 3*r*r*(t-e)+6*r*i*(n-t)+3*i*i*(s-n)}function Ix(i,e,t,n,s){let r=(i-e)/(s-e);for(let o=0;o<8;o++){let a=e0(r,e,t,n,s)-i;if(Math.abs(a)<1e-10)break;let l=Px(r,e,t,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var wi=class{constructor(e,t,n,s){if(e===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(t===void 0||t.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+e);this.name=e,this.times=vo(t,this.TimeBufferType),this.values=vo(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(e){let t=e.constructor,n;if(t.toJSON!==this.toJSON)n=t.toJSON(e);else{n={name:e.name,times:vo(e.times,Array),values:vo(e.values,Array)};let s=e.getInterpolation();s!==e.DefaultInterpolation&&(n.interpolation=s),vc(e.settings)&&(n.settings={inTangents:vo(e.settings.inTangents,Array),outTangents:vo(e.settings.outTangents,Array)})}return n.type=e.ValueTypeName,n}InterpolantFactoryMethodDiscrete(e){return new Xc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodLinear(e){return new Wc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodSmooth(e){return new Hc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodBezier(e){let t=new qc(this.times,this.values,this.getValueSize(),e);return this.settings&&(t.inTangents=this.settings.inTangents,t.outTangents=this.settings.outTangents),t}setInterpolation(e){let t;switch(e){case Ra:t=this.InterpolantFactoryMethodDiscrete;break;case Nc:t=this.InterpolantFactoryMethodLinear;break;case Sc:t=this.InterpolantFactoryMethodSmooth;break;case Fd:t=this.InterpolantFactoryMethodBezier;break}if(t===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(e!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return Ye("KeyframeTrack:",n),this}return this.createInterpolant=t,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return Ra;case this.InterpolantFactoryMethodLinear:return Nc;case this.InterpolantFactoryMethodSmooth:return Sc;case this.InterpolantFactoryMethodBezier:return Fd}}getValueSize(){return this.values.length/this.times.length}shift(e){if(e!==0){let t=this.times;for(let n=0,s=t.length;n!==s;++n)t[n]+=e;vc(this.settings)&&(rg(this.settings.inTangents,e),rg(this.settings.outTangents,e))}return this}scale(e){if(e!==1){let t=this.times;for(let n=0,s=t.length;n!==s;++n)t[n]*=e;vc(this.settings)&&(og(this.settings.inTangents,e),og(this.settings.outTangents,e))}return this}trim(e,t){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<e;)++r;for(;o!==-1&&n[o]>t;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let e=!0,t=this.getValueSize();t-Math.floor(t)!==0&&(tt("KeyframeTrack: Invalid value size in track.",this),e=!1);let n=this.times,s=this.values,r=n.length;r===0&&(tt("KeyframeTrack: Track is empty.",this),e=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){tt("KeyframeTrack: Time is not a valid number.",this,a,l),e=!1;break}if(o!==null&&o>l){tt("KeyframeTrack: Out of order keys.",this,a,l,o),e=!1;break}o=l}if(s!==void 0&&qv(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){tt("KeyframeTrack: Value is not a valid number.",this,a,c),e=!1;break}}return e}optimize(){let e=this.times.slice(),t=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===Sc,r=e.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=e[a],h=e[a+1];if(c!==h&&(a!==1||c!==e[0]))if(s)l=!0;else{let d=a*n,u=d-n,f=d+n;for(let g=0;g!==n;++g){let y=t[d+g];if(y!==t[u+g]||y!==t[f+g]){l=!0;break}}}if(l){if(a!==o){e[o]=e[a];let d=a*n,u=o*n;for(let f=0;f!==n;++f)t[u+f]=t[d+f]}++o}}if(r>0){e[o]=e[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)t[l+c]=t[a+c];++o}return o!==e.length?(this.times=e.slice(0,o),this.values=t.slice(0,o*n)):(this.times=e,this.values=t),this}clone(){let e=this.times.slice(),t=this.values.slice(),n=this.constructor,s=new n(this.name,e,t);return s.createInterpolant=this.createInterpolant,vc(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function rg(i,e){for(let t=0,n=i.length;t!==n;t+=2)i[t]+=e}function og(i,e){for(let t=0,n=i.length;t!==n;t+=2)i[t]*=e}wi.prototype.ValueTypeName="";wi.prototype.TimeBufferType=Float32Array;wi.prototype.ValueBufferType=Float32Array;wi.prototype.DefaultInterpolation=Nc;var cr=class extends wi{constructor(e,t,n){super(e,t,n)}};cr.prototype.ValueTypeName="bool";cr.prototype.ValueBufferType=Array;cr.prototype.DefaultInterpolation=Ra;cr.prototype.InterpolantFactoryMethodLinear=void 0;cr.prototype.InterpolantFactoryMethodSmooth=void 0;var $c=class extends wi{constructor(e,t,n,s){super(e,t,n,s)}};$c.prototype.ValueTypeName="color";var Yc=class extends wi{constructor(e,t,n,s){super(e,t,n,s)}};Yc.prototype.ValueTypeName="number";var Zc=class extends lr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-t)/(s-t),c=e*a;for(let h=c+a;c!==h;c+=4)oi.slerpFlat(r,0,o,c-a,o,c,l);return r}},Wa=class extends wi{constructor(e,t,n,s){super(e,t,n,s)}InterpolantFactoryMethodLinear(e){return new Zc(this.times,this.values,this.getValueSize(),e)}};Wa.prototype.ValueTypeName="quaternion";Wa.prototype.InterpolantFactoryMethodSmooth=void 0;var hr=class extends wi{constructor(e,t,n){super(e,t,n)}};hr.prototype.ValueTypeName="string";hr.prototype.ValueBufferType=Array;hr.prototype.DefaultInterpolation=Ra;hr.prototype.InterpolantFactoryMethodLinear=void 0;hr.prototype.InterpolantFactoryMethodSmooth=void 0;var Kc=class extends wi{constructor(e,t,n,s){super(e,t,n,s)}};Kc.prototype.ValueTypeName="vector";var Jc=class{constructor(e,t,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=e,this.onProgress=t,this.onError=n,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,d){return c.push(h,d),this},this.removeHandler=function(h){let d=c.indexOf(h);return d!==-1&&c.splice(d,2),this},this.getHandler=function(h){for(let d=0,u=c.length;d<u;d+=2){let f=c[d],g=c[d+1];if(f.global&&(f.lastIndex=0),f.test(h))return g}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},t0=new Jc,jc=class{constructor(e){this.manager=e!==void 0?e:t0,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(e,t){let n=this;return new Promise(function(s,r){n.load(e,s,t,r)})}parse(){}setCrossOrigin(e){return this.crossOrigin=e,this}setWithCredentials(e){return this.withCredentials=e,this}setPath(e){return this.path=e,this}setResourcePath(e){return this.resourcePath=e,this}setRequestHeader(e){return this.requestHeader=e,this}setPriority(e){return this.priority=e,this}setCache(e){return this.cache=e,this}abort(){return this}};jc.DEFAULT_MATERIAL_NAME="__DEFAULT";var No=class extends Vn{static registerNode(e){this.prototype._lightNode=e}constructor(e,t=1){super(),this.isLight=!0,this.type="Light",this.color=new it(e),this.intensity=t}copy(e,t){return super.copy(e,t),this.color.copy(e.color),this.intensity=e.intensity,this}toJSON(e){let t=super.toJSON(e);return t.object.color=this.color.getHex(),t.object.intensity=this.intensity,t}},Xa=class extends No{constructor(e,t,n){super(e,n),this.isHemisphereLight=!0,this.type="HemisphereLight",this.position.copy(Vn.DEFAULT_UP),this.updateMatrix(),this.groundColor=new it(t)}copy(e,t){return super.copy(e,t),this.groundColor.copy(e.groundColor),this}toJSON(e){let t=super.toJSON(e);return t.object.groundColor=this.groundColor.getHex(),t}},Dd=new Mt,ag=new W,lg=new W,Qc=class{constructor(e){this.camera=e,this.intensity=1,this.bias=0,this.biasNode=null,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new Ze(512,512),this.mapType=ui,this.map=null,this.mapPass=null,this.matrix=new Mt,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new or,this._frameExtents=new Ze(1,1),this._viewportCount=1,this._viewports=[new tn(0,0,1,1)]}getViewportCount(){return this._viewportCount}getCamera(){return this.camera}getFrustum(){return this._frustum}updateMatrices(e){let t=this.camera;ag.setFromMatrixPosition(e.matrixWorld),t.position.copy(ag),lg.setFromMatrixPosition(e.target.matrixWorld),t.lookAt(lg),t.updateMatrixWorld(),this._updateMatrix(t,this.matrix,this._frustum)}_updateMatrix(e,t,n,s){Dd.multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse),n.setFromProjectionMatrix(Dd,e.coordinateSystem,e.reversedDepth);let r=this._frameExtents,o=s?s.z/r.x:1,a=s?s.w/r.y:1,l=s?s.x/r.x:0,c=s?s.y/r.y:0;e.coordinateSystem===wo||e.reversedDepth?t.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,1,0,0,0,0,1):t.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,.5,.5,0,0,0,1),t.multiply(Dd)}getViewport(e){return this._viewports[e]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(e){return this.camera=e.camera.clone(),this.intensity=e.intensity,this.bias=e.bias,this.radius=e.radius,this.autoUpdate=e.autoUpdate,this.needsUpdate=e.needsUpdate,this.normalBias=e.normalBias,this.blurSamples=e.blurSamples,this.mapSize.copy(e.mapSize),this.mapType=e.mapType,this.biasNode=e.biasNode,this}clone(){return new this.constructor().copy(this)}toJSON(){let e={};return e.intensity=this.intensity,e.bias=this.bias,e.normalBias=this.normalBias,e.radius=this.radius,e.blurSamples=this.blurSamples,e.mapSize=this.mapSize.toArray(),e.mapType=this.mapType,e.camera=this.camera.toJSON(!1).object,delete e.camera.matrix,e}},xc=new W,bc=new oi,ps=new W,qa=class extends Vn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Mt,this.projectionMatrix=new Mt,this.projectionMatrixInverse=new Mt,this.coordinateSystem=Di,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(e,t){return super.copy(e,t),this.matrixWorldInverse.copy(e.matrixWorldInverse),this.projectionMatrix.copy(e.projectionMatrix),this.projectionMatrixInverse.copy(e.projectionMatrixInverse),this.coordinateSystem=e.coordinateSystem,this}getWorldDirection(e){return super.getWorldDirection(e).negate()}updateMatrixWorld(e){super.updateMatrixWorld(e),this.matrixWorld.decompose(xc,bc,ps),ps.x===1&&ps.y===1&&ps.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(xc,bc,ps.set(1,1,1)).invert()}updateWorldMatrix(e,t,n=!1){super.updateWorldMatrix(e,t,n),this.matrixWorld.decompose(xc,bc,ps),ps.x===1&&ps.y===1&&ps.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(xc,bc,ps.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},ir=new W,cg=new Ze,hg=new Ze,si=class extends qa{constructor(e=50,t=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=e,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=t,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.fov=e.fov,this.zoom=e.zoom,this.near=e.near,this.far=e.far,this.focus=e.focus,this.aspect=e.aspect,this.view=e.view===null?null:Object.assign({},e.view),this.filmGauge=e.filmGauge,this.filmOffset=e.filmOffset,this}setFocalLength(e){let t=.5*this.getFilmHeight()/e;this.fov=Eo*2*Math.atan(t),this.updateProjectionMatrix()}getFocalLength(){let e=Math.tan(Ea*.5*this.fov);return .5*this.getFilmHeight()/e}getEffectiveFOV(){return Eo*2*Math.atan(Math.tan(Ea*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(e,t,n){ir.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),t.set(ir.x,ir.y).multiplyScalar(-e/ir.z),ir.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(ir.x,ir.y).multiplyScalar(-e/ir.z)}getViewSize(e,t){return this.getViewBounds(e,cg,hg),t.subVectors(hg,cg)}setViewOffset(e,t,n,s,r,o){this.aspect=e/t,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=this.near,t=e*Math.tan(Ea*.5*this.fov)/this.zoom,n=2*t,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,t-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=e*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,t,t-n,e,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.fov=this.fov,t.object.zoom=this.zoom,t.object.near=this.near,t.object.far=this.far,t.object.focus=this.focus,t.object.aspect=this.aspect,this.view!==null&&(t.object.view=Object.assign({},this.view)),t.object.filmGauge=this.filmGauge,t.object.filmOffset=this.filmOffset,t}};var $a=class extends qa{constructor(e=-1,t=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=e,this.right=t,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.left=e.left,this.right=e.right,this.top=e.top,this.bottom=e.bottom,this.near=e.near,this.far=e.far,this.zoom=e.zoom,this.view=e.view===null?null:Object.assign({},e.view),this}setViewOffset(e,t,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=(this.right-this.left)/(2*this.zoom),t=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-e,o=n+e,a=s+t,l=s-t;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.zoom=this.zoom,t.object.left=this.left,t.object.right=this.right,t.object.top=this.top,t.object.bottom=this.bottom,t.object.near=this.near,t.object.far=this.far,this.view!==null&&(t.object.view=Object.assign({},this.view)),t}},zd=class extends Qc{constructor(){super(new $a(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},Do=class extends No{constructor(e,t){super(e,t),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(Vn.DEFAULT_UP),this.updateMatrix(),this.target=new Vn,this.shadow=new zd}dispose(){super.dispose(),this.shadow.dispose()}copy(e){return super.copy(e),this.target=e.target.clone(),this.shadow=e.shadow.clone(),this}toJSON(e){let t=super.toJSON(e);return t.object.shadow=this.shadow.toJSON(),t.object.target=this.target.uuid,t}},Ya=class extends No{constructor(e,t){super(e,t),this.isAmbientLight=!0,this.type="AmbientLight"}};var xo=-90,bo=1,Fo=class extends Vn{constructor(e,t,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new si(xo,bo,e,t);s.layers=this.layers,this.add(s);let r=new si(xo,bo,e,t);r.layers=this.layers,this.add(r);let o=new si(xo,bo,e,t);o.layers=this.layers,this.add(o);let a=new si(xo,bo,e,t);a.layers=this.layers,this.add(a);let l=new si(xo,bo,e,t);l.layers=this.layers,this.add(l);let c=new si(xo,bo,e,t);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let e=this.coordinateSystem,t=this.children.concat(),[n,s,r,o,a,l]=t;for(let c of t)this.remove(c);if(e===Di)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(e===wo)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+e);for(let c of t)this.add(c),c.updateMatrixWorld()}update(e,t){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==e.coordinateSystem&&(this.coordinateSystem=e.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,d=e.getRenderTarget(),u=e.getActiveCubeFace(),f=e.getActiveMipmapLevel(),g=e.xr.enabled;e.xr.enabled=!1;let y=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let p=!1;e.isWebGLRenderer===!0?p=e.state.buffers.depth.getReversed():p=e.reversedDepthBuffer,e.setRenderTarget(n,0,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,r),e.setRenderTarget(n,1,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,o),e.setRenderTarget(n,2,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,a),e.setRenderTarget(n,3,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,l),e.setRenderTarget(n,4,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,c),n.texture.mipmapsAutoUpdate=y,e.setRenderTarget(n,5,s),p&&e.autoClear===!1&&e.clearDepth(),e.render(t,h),e.setRenderTarget(d,u,f),e.xr.enabled=g,n.texture.needsPMREMUpdate=!0}},eh=class extends si{constructor(e=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=e,this.perCameraFrustumCulled=!1}};var bf="\\[\\]\\.:\\/",Lx=new RegExp("["+bf+"]","g"),Sf="[^"+bf+"]",Nx="[^"+bf.replace("\\.","")+"]",Dx=/((?:WC+[\/:])*)/.source.replace("WC",Sf),Fx=/(WCOD+)?/.source.replace("WCOD",Nx),Ux=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",Sf),Ox=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",Sf),kx=new RegExp("^"+Dx+Fx+Ux+Ox+"$"),Bx=["material","materials","bones","map"],Vd=class{constructor(e,t,n){let s=n||Yt.parseTrackName(t);this._targetGroup=e,this._bindings=e.subscribe_(t,s)}getValue(e,t){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(e,t)}setValue(e,t){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(e,t)}bind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].bind()}unbind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].unbind()}},Yt=class i{constructor(e,t,n){this.path=t,this.parsedPath=n||i.parseTrackName(t),this.node=i.findNode(e,this.parsedPath.nodeName),this.rootNode=e,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(e,t,n){return e&&e.isAnimationObjectGroup?new i.Composite(e,t,n):new i(e,t,n)}static sanitizeNodeName(e){return e.replace(/\s/g,"_").replace(Lx,"")}static parseTrackName(e){let t=kx.exec(e);if(t===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+e);let n={nodeName:t[2],objectName:t[3],objectIndex:t[4],propertyName:t[5],propertyIndex:t[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);Bx.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+e);return n}static findNode(e,t){if(t===void 0||t===""||t==="."||t===-1||t===e.name||t===e.uuid)return e;if(e.skeleton){let n=e.skeleton.getBoneByName(t);if(n!==void 0)return n}if(e.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===t||a.uuid===t)return a;let l=n(a.children);if(l)return l}return null},s=n(e.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(e,t){e[t]=this.targetObject[this.propertyName]}_getValue_array(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)e[t++]=n[s]}_getValue_arrayElement(e,t){e[t]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(e,t){this.resolvedProperty.toArray(e,t)}_setValue_direct(e,t){this.targetObject[this.propertyName]=e[t]}_setValue_direct_setNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++]}_setValue_array_setNeedsUpdate(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(e,t){this.resolvedProperty[this.propertyIndex]=e[t]}_setValue_arrayElement_setNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(e,t){this.resolvedProperty.fromArray(e,t)}_setValue_fromArray_setNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(e,t){this.bind(),this.getValue(e,t)}_setValue_unbound(e,t){this.bind(),this.setValue(e,t)}bind(){let e=this.node,t=this.parsedPath,n=t.objectName,s=t.propertyName,r=t.propertyIndex;if(e||(e=i.findNode(this.rootNode,t.nodeName),this.node=e),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!e){Ye("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=t.objectIndex;switch(n){case"materials":if(!e.material){tt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.materials){tt("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}e=e.material.materials;break;case"bones":if(!e.skeleton){tt("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}e=e.skeleton.bones;for(let h=0;h<e.length;h++)if(e[h].name===c){c=h;break}break;case"map":if("map"in e){e=e.map;break}if(!e.material){tt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.map){tt("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}e=e.material.map;break;default:if(e[n]===void 0){tt("PropertyBinding: Can not bind to objectName of node undefined.",this);return}e=e[n]}if(c!==void 0){if(e[c]===void 0){tt("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,e);return}e=e[c]}}let o=e[s];if(o===void 0){let c=t.nodeName;tt("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",e);return}let a=this.Versioning.None;this.targetObject=e,e.isMaterial===!0?a=this.Versioning.NeedsUpdate:e.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!e.geometry){tt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!e.geometry.morphAttributes){tt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}e.morphTargetDictionary[r]!==void 0&&(r=e.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};Yt.Composite=Vd;Yt.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};Yt.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};Yt.prototype.GetterByBindingType=[Yt.prototype._getValue_direct,Yt.prototype._getValue_array,Yt.prototype._getValue_arrayElement,Yt.prototype._getValue_toArray];Yt.prototype.SetterByBindingTypeAndVersioning=[[Yt.prototype._setValue_direct,Yt.prototype._setValue_direct_setNeedsUpdate,Yt.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[Yt.prototype._setValue_array,Yt.prototype._setValue_array_setNeedsUpdate,Yt.prototype._setValue_array_setMatrixWorldNeedsUpdate],[Yt.prototype._setValue_arrayElement,Yt.prototype._setValue_arrayElement_setNeedsUpdate,Yt.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[Yt.prototype._setValue_fromArray,Yt.prototype._setValue_fromArray_setNeedsUpdate,Yt.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var AR=new Float32Array(1);var ug=new Mt,Za=class{constructor(e,t,n=0,s=1/0){this.ray=new Fs(e,t),this.near=n,this.far=s,this.camera=null,this.layers=new Ro,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(e,t){this.ray.set(e,t)}setFromCamera(e,t){t.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(e.x,e.y,.5).unproject(t).sub(this.ray.origin).normalize(),this.camera=t):t.isOrthographicCamera?(this.ray.origin.set(e.x,e.y,t.projectionMatrix.elements[14]).unproject(t),this.ray.direction.set(0,0,-1).transformDirection(t.matrixWorld),this.camera=t):tt("Raycaster: Unsupported camera type: "+t.type)}setFromXRController(e){return ug.identity().extractRotation(e.matrixWorld),this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(ug),this}intersectObject(e,t=!0,n=[]){return Gd(e,this,n,t),n.sort(dg),n}intersectObjects(e,t=!0,n=[]){for(let s=0,r=e.length;s<r;s++)Gd(e[s],this,n,t);return n.sort(dg),n}};function dg(i,e){return i.distance-e.distance}function Gd(i,e,t,n){let s=!0;if(i.layers.test(e.layers)&&i.raycast(e,t)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)Gd(r[o],e,t,!0)}}var Uo=class{constructor(e=1,t=0,n=0){this.radius=e,this.phi=t,this.theta=n}set(e,t,n){return this.radius=e,this.phi=t,this.theta=n,this}copy(e){return this.radius=e.radius,this.phi=e.phi,this.theta=e.theta,this}makeSafe(){return this.phi=gt(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(e){return this.setFromCartesianCoords(e.x,e.y,e.z)}setFromCartesianCoords(e,t,n){return this.radius=Math.sqrt(e*e+t*t+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(e,n),this.phi=Math.acos(gt(t/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var Hd=class{static{this.prototype.isMatrix2=!0}constructor(e,t,n,s){this.elements=[1,0,0,1],e!==void 0&&this.set(e,t,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(e,t=0){for(let n=0;n<4;n++)this.elements[n]=e[n+t];return this}set(e,t,n,s){let r=this.elements;return r[0]=e,r[2]=t,r[1]=n,r[3]=s,this}};var Ka=class extends Ki{constructor(e,t=null){super(),this.object=e,this.domElement=t,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(e){this.domElement!==null&&this.disconnect(),this.domElement=e}disconnect(){}dispose(){}update(){}};function Mf(i,e,t,n){let s=zx(n);switch(t){case cf:return i*e;case lh:return i*e/s.components*s.byteLength;case ch:return i*e/s.components*s.byteLength;case dr:return i*e*2/s.components*s.byteLength;case hh:return i*e*2/s.components*s.byteLength;case hf:return i*e*3/s.components*s.byteLength;case ts:return i*e*4/s.components*s.byteLength;case uh:return i*e*4/s.components*s.byteLength;case ja:case Qa:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*8;case el:case tl:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case fh:case mh:return Math.max(i,16)*Math.max(e,8)/4;case dh:case ph:return Math.max(i,8)*Math.max(e,8)/2;case gh:case yh:case vh:case xh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*8;case _h:case nl:case bh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case Sh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case Mh:return Math.floor((i+4)/5)*Math.floor((e+3)/4)*16;case wh:return Math.floor((i+4)/5)*Math.floor((e+4)/5)*16;case Th:return Math.floor((i+5)/6)*Math.floor((e+4)/5)*16;case Eh:return Math.floor((i+5)/6)*Math.floor((e+5)/6)*16;case Ah:return Math.floor((i+7)/8)*Math.floor((e+4)/5)*16;case Rh:return Math.floor((i+7)/8)*Math.floor((e+5)/6)*16;case Ch:return Math.floor((i+7)/8)*Math.floor((e+7)/8)*16;case Ph:return Math.floor((i+9)/10)*Math.floor((e+4)/5)*16;case Ih:return Math.floor((i+9)/10)*Math.floor((e+5)/6)*16;case Lh:return Math.floor((i+9)/10)*Math.floor((e+7)/8)*16;case Nh:return Math.floor((i+9)/10)*Math.floor((e+9)/10)*16;case Dh:return Math.floor((i+11)/12)*Math.floor((e+9)/10)*16;case Fh:return Math.floor((i+11)/12)*Math.floor((e+11)/12)*16;case Uh:case Oh:case kh:return Math.ceil(i/4)*Math.ceil(e/4)*16;case Bh:case zh:return Math.ceil(i/4)*Math.ceil(e/4)*8;case il:case Vh:return Math.ceil(i/4)*Math.ceil(e/4)*16}throw new Error(`Unable to determine texture byte length for ${t} format.`)}function zx(i){switch(i){case ui:case rf:return{byteLength:1,components:1};case zo:case of:case es:return{byteLength:2,components:1};case oh:case ah:return{byteLength:2,components:4};case Qi:case rh:case ki:return{byteLength:4,components:1};case af:case lf:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Ye("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function M0(){let i=null,e=!1,t=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),t(r,o)}return{start:function(){e!==!0&&t!==null&&i!==null&&(n=i.requestAnimationFrame(s),e=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),e=!1},setAnimationLoop:function(r){t=r},setContext:function(r){i=r}}}function Gx(i){let e=new WeakMap;function t(a,l){let c=a.array,h=a.usage,d=c.byteLength,u=i.createBuffer();i.bindBuffer(l,u),i.bufferData(l,c,h),a.onUploadCallback();let f;if(c instanceof Float32Array)f=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)f=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?f=i.HALF_FLOAT:f=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)f=i.SHORT;else if(c instanceof Uint32Array)f=i.UNSIGNED_INT;else if(c instanceof Int32Array)f=i.INT;else if(c instanceof Int8Array)f=i.BYTE;else if(c instanceof Uint8Array)f=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)f=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:u,type:f,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:d}}function n(a,l,c){let h=l.array,d=l.updateRanges;if(i.bindBuffer(c,a),d.length===0)i.bufferSubData(c,0,h);else{d.sort((f,g)=>f.start-g.start);let u=0;for(let f=1;f<d.length;f++){let g=d[u],y=d[f];y.start<=g.start+g.count+1?g.count=Math.max(g.count,y.start+y.count-g.start):(++u,d[u]=y)}d.length=u+1;for(let f=0,g=d.length;f<g;f++){let y=d[f];i.bufferSubData(c,y.start*h.BYTES_PER_ELEMENT,h,y.start,y.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),e.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=e.get(a);l&&(i.deleteBuffer(l.buffer),e.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=e.get(a);(!h||h.version<a.version)&&e.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=e.get(a);if(c===void 0)e.set(a,t(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var Hx=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,Wx=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,Xx=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,qx=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,$x=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,Yx=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,Zx=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,Kx=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,Jx=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,jx=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,Qx=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,eb=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,tb=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,nb=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,ib=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,sb=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,rb=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,ob=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,ab=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,lb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,cb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,hb=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,ub=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,db=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,fb=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,pb=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,mb=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,gb=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,yb=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,_b="gl_FragColor = linearToOutputTexel( gl_FragColor );",vb=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,xb=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,bb=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,Sb=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,Mb=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,wb=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,Tb=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,Eb=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,Ab=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,Rb=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,Cb=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,Pb=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Ib=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Lb=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,Nb=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,Db=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,Fb=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,Ub=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,Ob=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,kb=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,Bb=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,zb=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,Vb=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,Gb=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,Hb=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,Wb=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,Xb=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,qb=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,$b=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Yb=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,Zb=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,Kb=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,Jb=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,jb=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,Qb=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,eS=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,tS=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,nS=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,iS=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,sS=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,rS=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,oS=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,aS=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,lS=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,cS=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,hS=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,uS=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,dS=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,fS=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,pS=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,mS=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,gS=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,yS=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,_S=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,vS=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,xS=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,bS=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,SS=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,MS=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,wS=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,TS=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,ES=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,AS=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,RS=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,CS=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,PS=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,IS=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,LS=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,NS=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,DS=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,FS=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,US=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,OS=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,kS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,BS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,zS=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,VS=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,GS=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,HS=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,WS=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,XS=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,qS=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,$S=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,YS=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,ZS=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,KS=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,JS=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,jS=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,QS=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,eM=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,tM=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,nM=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,iM=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,sM=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,rM=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,oM=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,aM=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,lM=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,cM=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,hM=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,uM=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,dM=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,fM=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,pM=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,mM=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,gM=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,yM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,_M=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,vM=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,xM=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,bM=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,dt={alphahash_fragment:Hx,alphahash_pars_fragment:Wx,alphamap_fragment:Xx,alphamap_pars_fragment:qx,alphatest_fragment:$x,alphatest_pars_fragment:Yx,aomap_fragment:Zx,aomap_pars_fragment:Kx,batching_pars_vertex:Jx,batching_vertex:jx,begin_vertex:Qx,beginnormal_vertex:eb,bsdfs:tb,iridescence_fragment:nb,bumpmap_pars_fragment:ib,clipping_planes_fragment:sb,clipping_planes_pars_fragment:rb,clipping_planes_pars_vertex:ob,clipping_planes_vertex:ab,color_fragment:lb,color_pars_fragment:cb,color_pars_vertex:hb,color_vertex:ub,common:db,defaultnormal_vertex:fb,displacementmap_pars_vertex:pb,displacementmap_vertex:mb,emissivemap_fragment:gb,emissivemap_pars_fragment:yb,colorspace_fragment:_b,colorspace_pars_fragment:vb,envmap_fragment:xb,envmap_common_pars_fragment:bb,envmap_pars_fragment:Sb,envmap_pars_vertex:Mb,envmap_physical_pars_fragment:Db,envmap_vertex:wb,fog_vertex:Tb,fog_pars_vertex:Eb,fog_fragment:Ab,fog_pars_fragment:Rb,gradientmap_pars_fragment:Cb,lightmap_pars_fragment:Pb,lights_lambert_fragment:Ib,lights_lambert_pars_fragment:Lb,lights_pars_begin:Nb,lights_toon_fragment:Fb,lights_toon_pars_fragment:Ub,lights_phong_fragment:Ob,lights_phong_pars_fragment:kb,lights_physical_fragment:Bb,lights_physical_pars_fragment:zb,lights_fragment_begin:Vb,lights_fragment_maps:Gb,lights_fragment_end:Hb,lightprobes_pars_fragment:Wb,logdepthbuf_fragment:Xb,logdepthbuf_pars_fragment:qb,logdepthbuf_pars_vertex:$b,logdepthbuf_vertex:Yb,map_fragment:Zb,map_pars_fragment:Kb,map_particle_fragment:Jb,map_particle_pars_fragment:jb,metalnessmap_fragment:Qb,metalnessmap_pars_fragment:eS,morphinstance_vertex:tS,morphcolor_vertex:nS,morphnormal_vertex:iS,morphtarget_pars_vertex:sS,morphtarget_vertex:rS,normal_fragment_begin:oS,normal_fragment_maps:aS,normal_pars_fragment:lS,normal_pars_vertex:cS,normal_vertex:hS,normalmap_pars_fragment:uS,clearcoat_normal_fragment_begin:dS,clearcoat_normal_fragment_maps:fS,clearcoat_pars_fragment:pS,iridescence_pars_fragment:mS,opaque_fragment:gS,packing:yS,premultiplied_alpha_fragment:_S,project_vertex:vS,dithering_fragment:xS,dithering_pars_fragment:bS,roughnessmap_fragment:SS,roughnessmap_pars_fragment:MS,shadowmap_pars_fragment:wS,shadowmap_pars_vertex:TS,shadowmap_vertex:ES,shadowmask_pars_fragment:AS,skinbase_vertex:RS,skinning_pars_vertex:CS,skinning_vertex:PS,skinnormal_vertex:IS,specularmap_fragment:LS,specularmap_pars_fragment:NS,tonemapping_fragment:DS,tonemapping_pars_fragment:FS,transmission_fragment:US,transmission_pars_fragment:OS,uv_pars_fragment:kS,uv_pars_vertex:BS,uv_vertex:zS,worldpos_vertex:VS,background_vert:GS,background_frag:HS,backgroundCube_vert:WS,backgroundCube_frag:XS,cube_vert:qS,cube_frag:$S,depth_vert:YS,depth_frag:ZS,distance_vert:KS,distance_frag:JS,equirect_vert:jS,equirect_frag:QS,linedashed_vert:eM,linedashed_frag:tM,meshbasic_vert:nM,meshbasic_frag:iM,meshlambert_vert:sM,meshlambert_frag:rM,meshmatcap_vert:oM,meshmatcap_frag:aM,meshnormal_vert:lM,meshnormal_frag:cM,meshphong_vert:hM,meshphong_frag:uM,meshphysical_vert:dM,meshphysical_frag:fM,meshtoon_vert:pM,meshtoon_frag:mM,points_vert:gM,points_frag:yM,shadow_vert:_M,shadow_frag:vM,sprite_vert:xM,sprite_frag:bM},Le={common:{diffuse:{value:new it(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new st},alphaMap:{value:null},alphaMapTransform:{value:new st},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new st}},envmap:{envMap:{value:null},envMapRotation:{value:new st},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new st}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new st}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new st},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new st},normalScale:{value:new Ze(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new st},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new st}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new st}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new st}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new it(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new it(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new st},alphaTest:{value:0},uvTransform:{value:new st}},sprite:{diffuse:{value:new it(16777215)},opacity:{value:1},center:{value:new Ze(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new st},alphaMap:{value:null},alphaMapTransform:{value:new st},alphaTest:{value:0}}},vs={basic:{uniforms:Jn([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.fog]),vertexShader:dt.meshbasic_vert,fragmentShader:dt.meshbasic_frag},lambert:{uniforms:Jn([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,Le.lights,{emissive:{value:new it(0)},envMapIntensity:{value:1}}]),vertexShader:dt.meshlambert_vert,fragmentShader:dt.meshlambert_frag},phong:{uniforms:Jn([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,Le.lights,{emissive:{value:new it(0)},specular:{value:new it(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:dt.meshphong_vert,fragmentShader:dt.meshphong_frag},standard:{uniforms:Jn([Le.common,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.roughnessmap,Le.metalnessmap,Le.fog,Le.lights,{emissive:{value:new it(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:dt.meshphysical_vert,fragmentShader:dt.meshphysical_frag},toon:{uniforms:Jn([Le.common,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.gradientmap,Le.fog,Le.lights,{emissive:{value:new it(0)}}]),vertexShader:dt.meshtoon_vert,fragmentShader:dt.meshtoon_frag},matcap:{uniforms:Jn([Le.common,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,{matcap:{value:null}}]),vertexShader:dt.meshmatcap_vert,fragmentShader:dt.meshmatcap_frag},points:{uniforms:Jn([Le.points,Le.fog]),vertexShader:dt.points_vert,fragmentShader:dt.points_frag},dashed:{uniforms:Jn([Le.common,Le.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:dt.linedashed_vert,fragmentShader:dt.linedashed_frag},depth:{uniforms:Jn([Le.common,Le.displacementmap]),vertexShader:dt.depth_vert,fragmentShader:dt.depth_frag},normal:{uniforms:Jn([Le.common,Le.bumpmap,Le.normalmap,Le.displacementmap,{opacity:{value:1}}]),vertexShader:dt.meshnormal_vert,fragmentShader:dt.meshnormal_frag},sprite:{uniforms:Jn([Le.sprite,Le.fog]),vertexShader:dt.sprite_vert,fragmentShader:dt.sprite_frag},background:{uniforms:{uvTransform:{value:new st},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:dt.background_vert,fragmentShader:dt.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new st}},vertexShader:dt.backgroundCube_vert,fragmentShader:dt.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:dt.cube_vert,fragmentShader:dt.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:dt.equirect_vert,fragmentShader:dt.equirect_frag},distance:{uniforms:Jn([Le.common,Le.displacementmap,{referencePosition:{value:new W},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:dt.distance_vert,fragmentShader:dt.distance_frag},shadow:{uniforms:Jn([Le.lights,Le.fog,{color:{value:new it(0)},opacity:{value:1}}]),vertexShader:dt.shadow_vert,fragmentShader:dt.shadow_frag}};vs.physical={uniforms:Jn([vs.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new st},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new st},clearcoatNormalScale:{value:new Ze(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new st},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new st},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new st},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new st},sheen:{value:0},sheenColor:{value:new it(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new st},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new st},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new st},transmissionSamplerSize:{value:new Ze},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new st},attenuationDistance:{value:0},attenuationColor:{value:new it(0)},specularColor:{value:new it(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new st},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new st},anisotropyVector:{value:new Ze},anisotropyMap:{value:null},anisotropyMapTransform:{value:new st}}]),vertexShader:dt.meshphysical_vert,fragmentShader:dt.meshphysical_frag};var Hh={r:0,b:0,g:0},SM=new Mt,w0=new st;w0.set(-1,0,0,0,1,0,0,0,1);function MM(i,e,t,n,s,r){let o=new it(0),a=s===!0?0:1,l,c,h=null,d=0,u=null;function f(x){let A=x.isScene===!0?x.background:null;if(A&&A.isTexture){let S=x.backgroundBlurriness>0;A=e.get(A,S)}return A}function g(x){let A=!1,S=f(x);S===null?p(o,a):S&&S.isColor&&(p(S,1),A=!0);let R=i.xr.getEnvironmentBlendMode();R==="additive"?t.buffers.color.setClear(0,0,0,1,r):R==="alpha-blend"&&t.buffers.color.setClear(0,0,0,0,r),(i.autoClear||A)&&(t.buffers.depth.setTest(!0),t.buffers.depth.setMask(!0),t.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function y(x,A){let S=f(A);S&&S.isCubeTexture?(c===void 0&&(c=new Zt(new Io(1,1,1),new Fi({name:"BackgroundCubeMaterial",uniforms:Or(vs.backgroundCube.uniforms),vertexShader:vs.backgroundCube.vertexShader,fragmentShader:vs.backgroundCube.fragmentShader,side:ai,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(R,M,_){this.matrixWorld.copyPosition(_.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=S,c.material.uniforms.backgroundBlurriness.value=A.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=A.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(SM.makeRotationFromEuler(A.backgroundRotation)).transpose(),S.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(w0),c.material.toneMapped=vt.getTransfer(S.colorSpace)!==Ct,(h!==S||d!==S.version||u!==i.toneMapping)&&(c.material.needsUpdate=!0,h=S,d=S.version,u=i.toneMapping),c.layers.enableAll(),x.unshift(c,c.geometry,c.material,0,0,null)):S&&S.isTexture&&(l===void 0&&(l=new Zt(new Pr(2,2),new Fi({name:"BackgroundMaterial",uniforms:Or(vs.background.uniforms),vertexShader:vs.background.vertexShader,fragmentShader:vs.background.fragmentShader,side:ur,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=S,l.material.uniforms.backgroundIntensity.value=A.backgroundIntensity,l.material.toneMapped=vt.getTransfer(S.colorSpace)!==Ct,S.matrixAutoUpdate===!0&&S.updateMatrix(),l.material.uniforms.uvTransform.value.copy(S.matrix),(h!==S||d!==S.version||u!==i.toneMapping)&&(l.material.needsUpdate=!0,h=S,d=S.version,u=i.toneMapping),l.layers.enableAll(),x.unshift(l,l.geometry,l.material,0,0,null))}function p(x,A){x.getRGB(Hh,xf(i)),t.buffers.color.setClear(Hh.r,Hh.g,Hh.b,A,r)}function m(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(x,A=1){o.set(x),a=A,p(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(x){a=x,p(o,a)},render:g,addToRenderList:y,dispose:m}}function wM(i,e){let t=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=u(null),r=s,o=!1;function a(L,B,V,P,F){let X=!1,G=d(L,P,V,B);r!==G&&(r=G,c(r.object)),X=f(L,P,V,F),X&&g(L,P,V,F),F!==null&&e.update(F,i.ELEMENT_ARRAY_BUFFER),(X||o)&&(o=!1,S(L,B,V,P),F!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,e.get(F).buffer))}function l(){return i.createVertexArray()}function c(L){return i.bindVertexArray(L)}function h(L){return i.deleteVertexArray(L)}function d(L,B,V,P){let F=P.wireframe===!0,X=n[B.id];X===void 0&&(X={},n[B.id]=X);let G=L.isInstancedMesh===!0?L.id:0,oe=X[G];oe===void 0&&(oe={},X[G]=oe);let $=oe[V.id];$===void 0&&($={},oe[V.id]=$);let J=$[F];return J===void 0&&(J=u(l()),$[F]=J),J}function u(L){let B=[],V=[],P=[];for(let F=0;F<t;F++)B[F]=0,V[F]=0,P[F]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:B,enabledAttributes:V,attributeDivisors:P,object:L,attributes:{},index:null}}function f(L,B,V,P){let F=r.attributes,X=B.attributes,G=0,oe=V.getAttributes();for(let $ in oe)if(oe[$].location>=0){let ne=F[$],ue=X[$];if(ue===void 0&&($==="instanceMatrix"&&L.instanceMatrix&&(ue=L.instanceMatrix),$==="instanceColor"&&L.instanceColor&&(ue=L.instanceColor)),ne===void 0||ne.attribute!==ue||ue&&ne.data!==ue.data)return!0;G++}return r.attributesNum!==G||r.index!==P}function g(L,B,V,P){let F={},X=B.attributes,G=0,oe=V.getAttributes();for(let $ in oe)if(oe[$].location>=0){let ne=X[$];ne===void 0&&($==="instanceMatrix"&&L.instanceMatrix&&(ne=L.instanceMatrix),$==="instanceColor"&&L.instanceColor&&(ne=L.instanceColor));let ue={};ue.attribute=ne,ne&&ne.data&&(ue.data=ne.data),F[$]=ue,G++}r.attributes=F,r.attributesNum=G,r.index=P}function y(){let L=r.newAttributes;for(let B=0,V=L.length;B<V;B++)L[B]=0}function p(L){m(L,0)}function m(L,B){let V=r.newAttributes,P=r.enabledAttributes,F=r.attributeDivisors;V[L]=1,P[L]===0&&(i.enableVertexAttribArray(L),P[L]=1),F[L]!==B&&(i.vertexAttribDivisor(L,B),F[L]=B)}function x(){let L=r.newAttributes,B=r.enabledAttributes;for(let V=0,P=B.length;V<P;V++)B[V]!==L[V]&&(i.disableVertexAttribArray(V),B[V]=0)}function A(L,B,V,P,F,X,G){G===!0?i.vertexAttribIPointer(L,B,V,F,X):i.vertexAttribPointer(L,B,V,P,F,X)}function S(L,B,V,P){y();let F=P.attributes,X=V.getAttributes(),G=B.defaultAttributeValues;for(let oe in X){let $=X[oe];if($.location>=0){let J=F[oe];if(J===void 0&&(oe==="instanceMatrix"&&L.instanceMatrix&&(J=L.instanceMatrix),oe==="instanceColor"&&L.instanceColor&&(J=L.instanceColor)),J!==void 0){let ne=J.normalized,ue=J.itemSize,ce=e.get(J);if(ce===void 0)continue;let Q=ce.buffer,pe=ce.type,me=ce.bytesPerElement,ye=pe===i.INT||pe===i.UNSIGNED_INT||J.gpuType===rh;if(J.isInterleavedBufferAttribute){let ge=J.data,Ve=ge.isInterleavedBuffer===!0?ge.stride:ge.itemSize,Je=J.offset;if(ge.isInstancedInterleavedBuffer||ge.isInstancedBufferAttribute){for(let Ue=0;Ue<$.locationSize;Ue++)m($.location+Ue,ge.meshPerAttribute);L.isInstancedMesh!==!0&&P._maxInstanceCount===void 0&&(P._maxInstanceCount=ge.meshPerAttribute*ge.count)}else for(let Ue=0;Ue<$.locationSize;Ue++)p($.location+Ue);i.bindBuffer(i.ARRAY_BUFFER,Q);for(let Ue=0;Ue<$.locationSize;Ue++)A($.location+Ue,ue/$.locationSize,pe,ne,Ve*me,(Je+ue/$.locationSize*Ue)*me,ye)}else{if(J.isInstancedBufferAttribute){for(let ge=0;ge<$.locationSize;ge++)m($.location+ge,J.meshPerAttribute);L.isInstancedMesh!==!0&&P._maxInstanceCount===void 0&&(P._maxInstanceCount=J.meshPerAttribute*J.count)}else for(let ge=0;ge<$.locationSize;ge++)p($.location+ge);i.bindBuffer(i.ARRAY_BUFFER,Q);for(let ge=0;ge<$.locationSize;ge++)A($.location+ge,ue/$.locationSize,pe,ne,ue*me,ue/$.locationSize*ge*me,ye)}}else if(G!==void 0){let ne=G[oe];if(ne!==void 0)switch(ne.length){case 2:i.vertexAttrib2fv($.location,ne);break;case 3:i.vertexAttrib3fv($.location,ne);break;case 4:i.vertexAttrib4fv($.location,ne);break;default:i.vertexAttrib1fv($.location,ne)}}}}x()}function R(){k();for(let L in n){let B=n[L];for(let V in B){let P=B[V];for(let F in P){let X=P[F];for(let G in X)h(X[G].object),delete X[G];delete P[F]}}delete n[L]}}function M(L){if(n[L.id]===void 0)return;let B=n[L.id];for(let V in B){let P=B[V];for(let F in P){let X=P[F];for(let G in X)h(X[G].object),delete X[G];delete P[F]}}delete n[L.id]}function _(L){for(let B in n){let V=n[B];for(let P in V){let F=V[P];if(F[L.id]===void 0)continue;let X=F[L.id];for(let G in X)h(X[G].object),delete X[G];delete F[L.id]}}}function E(L){for(let B in n){let V=n[B],P=L.isInstancedMesh===!0?L.id:0,F=V[P];if(F!==void 0){for(let X in F){let G=F[X];for(let oe in G)h(G[oe].object),delete G[oe];delete F[X]}delete V[P],Object.keys(V).length===0&&delete n[B]}}}function k(){N(),o=!0,r!==s&&(r=s,c(r.object))}function N(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:k,resetDefaultState:N,dispose:R,releaseStatesOfGeometry:M,releaseStatesOfObject:E,releaseStatesOfProgram:_,initAttributes:y,enableAttribute:p,disableUnusedAttributes:x}}function TM(i,e,t){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),t.update(c,n,1)}function o(l,c,h){h!==0&&(i.drawArraysInstanced(n,l,c,h),t.update(c,n,h))}function a(l,c,h){if(h===0)return;e.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let u=0;for(let f=0;f<h;f++)u+=c[f];t.update(u,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function EM(i,e,t,n){let s;function r(){if(s!==void 0)return s;if(e.has("EXT_texture_filter_anisotropic")===!0){let _=e.get("EXT_texture_filter_anisotropic");s=i.getParameter(_.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(_){return!(_!==ts&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(_){let E=_===es&&(e.has("EXT_color_buffer_half_float")||e.has("EXT_color_buffer_float"));return!(_!==ui&&_!==ki&&!E&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(_){if(_==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";_="mediump"}return _==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=t.precision!==void 0?t.precision:"highp",h=l(c);h!==c&&(Ye("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let d=t.reversedDepthBuffer===!0&&e.has("EXT_clip_control"),u=t.logarithmicDepthBuffer===!0&&d===!1;t.reversedDepthBuffer===!0&&d===!1&&Ye("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),t.logarithmicDepthBuffer===!0&&d===!0&&Ye("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let f=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),g=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),y=i.getParameter(i.MAX_TEXTURE_SIZE),p=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),m=i.getParameter(i.MAX_VERTEX_ATTRIBS),x=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),A=i.getParameter(i.MAX_VARYING_VECTORS),S=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),R=i.getParameter(i.MAX_SAMPLES),M=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:u,reversedDepthBuffer:d,maxTextures:f,maxVertexTextures:g,maxTextureSize:y,maxCubemapSize:p,maxAttributes:m,maxVertexUniforms:x,maxVaryings:A,maxFragmentUniforms:S,maxSamples:R,samples:M}}function AM(i){let e=this,t=null,n=0,s=!1,r=!1,o=new ii,a=new st,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(d,u){let f=d.length!==0||u||n!==0||s;return s=u,n=d.length,f},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(d,u){t=h(d,u,0)},this.setState=function(d,u,f){let g=d.clippingPlanes,y=d.clipIntersection,p=d.clipShadows,m=i.get(d);if(!s||g===null||g.length===0||r&&!p)r?h(null):c();else{let x=r?0:n,A=x*4,S=m.clippingState||null;l.value=S,S=h(g,u,A,f);for(let R=0;R!==A;++R)S[R]=t[R];m.clippingState=S,this.numIntersection=y?this.numPlanes:0,this.numPlanes+=x}};function c(){l.value!==t&&(l.value=t,l.needsUpdate=n>0),e.numPlanes=n,e.numIntersection=0}function h(d,u,f,g){let y=d!==null?d.length:0,p=null;if(y!==0){if(p=l.value,g!==!0||p===null){let m=f+y*4,x=u.matrixWorldInverse;a.getNormalMatrix(x),(p===null||p.length<m)&&(p=new Float32Array(m));for(let A=0,S=f;A!==y;++A,S+=4)o.copy(d[A]).applyMatrix4(x,a),o.normal.toArray(p,S),p[S+3]=o.constant}l.value=p,l.needsUpdate=!0}return e.numPlanes=y,e.numIntersection=0,p}}var ol=class extends Si{constructor(e=1,t={}){super(e,e,t),this.isWebGLCubeRenderTarget=!0;let n={width:e,height:e,depth:1},s=[n,n,n,n,n,n];this.texture=new Ba(s),this._setTextureOptions(t),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(e,t){this.texture.type=t.type,this.texture.colorSpace=t.colorSpace,this.texture.generateMipmaps=t.generateMipmaps,this.texture.minFilter=t.minFilter,this.texture.magFilter=t.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new Io(5,5,5),r=new Fi({name:"CubemapFromEquirect",uniforms:Or(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:ai,blending:Nr});r.uniforms.tEquirect.value=t;let o=new Zt(s,r),a=t.minFilter;return t.minFilter===ks&&(t.minFilter=ri),new Fo(1,10,this).update(e,o),t.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(e,t=!0,n=!0,s=!0){let r=e.getRenderTarget();for(let o=0;o<6;o++)e.setRenderTarget(this,o),e.clear(t,n,s);e.setRenderTarget(r)}},n0=256,RM=3,CM=20,T0=256,E0=16,PM=3,IM=new W,LM=new it,Xh=class i{constructor(e){this._renderer=e,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new Fo(1,10,null),this._boxMesh=new Zt(new Io(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(e,t=0,n=.1,s=100,r={}){let{size:o=256,position:a=IM}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),h=this._getSourceTarget(!0);t>0&&(h.texture.mipmapsAutoUpdate=!1);let d=l.autoClear,u=l.autoClearColor,f=l.autoClearDepth,g=l.autoClearStencil,y=e.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,y===null&&(e.background=l.getClearColor(LM));let p=new Fo(n,s,h);return p.position.copy(a),p.update(l,e),l.autoClear=d,l.autoClearColor=u,l.autoClearDepth=f,l.autoClearStencil=g,e.background=y,t>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,t)),this._applyPMREM(c),c}fromEquirectangular(e,t=null){return this._fromTexture(e,t)}fromCubemap(e,t=null){return this._fromTexture(e,t)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=r0(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=s0(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(e,t){return t>0?1-Math.sqrt(1-e/t):0}_setSize(e){this._cubeSize=Math.max(n0,yf(e))}_fromTexture(e,t){e.mapping===Fr||e.mapping===Bo?this._setSize(e.image.length===0?n0:e.image[0].width||e.image[0].image.width):this._setSize(e.image.width/4);let n=t||this._allocateTarget();return this._textureToCubemap(e),this._applyPMREM(n),n}_allocateTarget(){let e=this._cubeSize,t=i0(e,!1,!1),n=Math.log2(e)-RM;for(let s=0;s<=n;s++)t.texture.mipmaps.push({width:e>>s,height:e>>s});return t.texture.name="PMREM",t.texture.isPMREMTexture=!0,t}_getSourceTarget(e=!1){let t=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==t||e&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=i0(t,!0,e)),this._sourceTarget}_compileMaterial(e){this._boxMesh.material=e,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(e,t,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=e,r.activeMipmapLevel=t;let o=e.width>>t;e.viewport.set(0,0,o,o),r.update(this._renderer,s),e.viewport.set(0,0,e.width,e.height)}_textureToCubemap(e){let t;e.mapping===Fr||e.mapping===Bo?(this._cubemapMaterial===null&&(this._cubemapMaterial=r0()),t=this._cubemapMaterial,t.uniforms.flipEnvMap.value=e.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=s0()),t=this._equirectMaterial),t.uniforms.envMap.value=e,this._renderCube(this._getSourceTarget(),0,t)}_applyPMREM(e){this._ggxMaterial===null&&(this._ggxMaterial=NM(),this._integrationMaterial=DM());let t=this._cubeSize,n=e.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(t/E0);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-PM)r.roughness.value=a,this._renderCube(e,o,this._integrationMaterial);else{let l=a>0?Math.log2(t)+.5*Math.log2(6/(T0*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(e,o,this._ggxMaterial)}}}_blur(e,t){this._blurMaterial===null&&(this._blurMaterial=FM());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(t,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(e,0,n),s.envMap.value=e.texture,this._renderCube(r,0,n)}};function i0(i,e,t){return new ol(i,{minFilter:ks,generateMipmaps:e,type:es,colorSpace:Ca,depthBuffer:t})}function al(i,e,t){return new Fi({name:i,uniforms:e,vertexShader:dt.cube_vert,fragmentShader:t,side:ai,blending:Nr,depthTest:!1,depthWrite:!1})}function NM(){return al("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${T0}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function DM(){return al("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:E0}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function FM(){return al("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${CM}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function s0(){return al("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function r0(){return al("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function UM(i){let e=new WeakMap,t=new WeakMap,n=null;function s(u,f=!1){return u==null?null:f?o(u):r(u)}function r(u){if(u&&u.isTexture){let f=u.mapping;if(f===nh||f===ih)if(e.has(u)){let g=e.get(u).texture;return a(g,u.mapping)}else{let g=u.image;if(g&&g.height>0){let y=new ol(g.height);return y.fromEquirectangularTexture(i,u),e.set(u,y),u.addEventListener("dispose",c),a(y.texture,u.mapping)}else return null}}return u}function o(u){if(u&&u.isTexture&&u.isPMREMTexture!==!0){let f=u.mapping,g=f===nh||f===ih,y=f===Fr||f===Bo;if(g||y){let p=t.get(u),m=p!==void 0?p.texture.pmremVersion:0;if(u.isRenderTargetTexture&&u.pmremVersion!==m)return n===null&&(n=new Xh(i)),p=g?n.fromEquirectangular(u,p):n.fromCubemap(u,p),p.texture.pmremVersion=u.pmremVersion,t.set(u,p),p.texture;if(p!==void 0)return p.texture;{let x=u.image;return g&&x&&x.height>0||y&&x&&l(x)?(n===null&&(n=new Xh(i)),p=g?n.fromEquirectangular(u):n.fromCubemap(u),p.texture.pmremVersion=u.pmremVersion,t.set(u,p),u.addEventListener("dispose",h),p.texture):null}}}return u}function a(u,f){return f===nh?u.mapping=Fr:f===ih&&(u.mapping=Bo),u}function l(u){let f=0,g=6;for(let y=0;y<g;y++)u[y]!==void 0&&f++;return f===g}function c(u){let f=u.target;f.removeEventListener("dispose",c);let g=e.get(f);g!==void 0&&(e.delete(f),g.dispose())}function h(u){let f=u.target;f.removeEventListener("dispose",h);let g=t.get(f);g!==void 0&&(t.delete(f),g.dispose())}function d(){e=new WeakMap,t=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:d}}function OM(i){let e={};function t(n){if(e[n]!==void 0)return e[n];let s=i.getExtension(n);return e[n]=s,s}return{has:function(n){return t(n)!==null},init:function(){t("EXT_color_buffer_float"),t("WEBGL_clip_cull_distance"),t("OES_texture_float_linear"),t("EXT_color_buffer_half_float"),t("WEBGL_multisampled_render_to_texture"),t("WEBGL_render_shared_exponent")},get:function(n){let s=t(n);return s===null&&Ta("WebGLRenderer: "+n+" extension not supported."),s}}}function kM(i,e,t,n){let s={},r=new WeakMap,o=new FinalizationRegistry(g=>delete s[g]);function a(g){l(g.target)}function l(g){g.index!==null&&e.remove(g.index);for(let p in g.attributes)e.remove(g.attributes[p]);g.removeEventListener("dispose",a),delete s[g.id],o.unregister(g);let y=r.get(g);y&&(e.remove(y),r.delete(g)),n.releaseStatesOfGeometry(g),g.isInstancedBufferGeometry===!0&&delete g._maxInstanceCount,t.memory.geometries--}function c(g,y){return s[y.id]!==void 0||(y.addEventListener("dispose",a),s[y.id]=new WeakRef(y),o.register(y,y.id,y),t.memory.geometries++),y}function h(g){let y=g.attributes;for(let p in y)e.update(y[p],i.ARRAY_BUFFER)}function d(g){let y=g.index,p=g.attributes.position,m=0;if(p===void 0)return;let x=y!==null?y.array.length:p.array.length/3-1,A=p.count>=65535?Fa:Da,S=new A(Math.ceil(x/3)*6,1),R=S.array;if(y!==null){let _=y.array;m=y.version;for(let E=0,k=0;E<x;E+=3){let N=_[E+0],L=_[E+1],B=_[E+2];R[k++]=N,R[k++]=L,R[k++]=L,R[k++]=B,R[k++]=B,R[k++]=N}}else{m=p.version;for(let _=0,E=0;_<x;_+=3){let k=_+0,N=_+1,L=_+2;R[E++]=k,R[E++]=N,R[E++]=N,R[E++]=L,R[E++]=L,R[E++]=k}}S.version=m;let M=r.get(g);M&&e.remove(M),r.set(g,S)}function u(g){let y=r.get(g);if(y){let p=g.index;p!==null&&y.version<p.version&&d(g)}else d(g);return r.get(g)}function f(){for(let g in s){let y=s[g].deref();y!==void 0&&l(y)}}return{get:c,update:h,getWireframeAttribute:u,dispose:f}}function BM(i,e,t){let n;function s(d){n=d}let r,o;function a(d){r=d.type,o=d.bytesPerElement}function l(d,u){i.drawElements(n,u,r,d*o),t.update(u,n,1)}function c(d,u,f){f!==0&&(i.drawElementsInstanced(n,u,r,d*o,f),t.update(u,n,f))}function h(d,u,f){if(f===0)return;e.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,u,0,r,d,0,f);let y=0;for(let p=0;p<f;p++)y+=u[p];t.update(y,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function zM(i){let e={geometries:0,textures:0},t={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(t.calls++,o){case i.TRIANGLES:t.triangles+=a*(r/3);break;case i.LINES:t.lines+=a*(r/2);break;case i.LINE_STRIP:t.lines+=a*(r-1);break;case i.LINE_LOOP:t.lines+=a*r;break;case i.POINTS:t.points+=a*r;break;default:tt("WebGLInfo: Unknown draw mode:",o);break}}function s(){t.calls=0,t.triangles=0,t.points=0,t.lines=0}return{memory:e,render:t,programs:null,autoReset:!0,reset:s,update:n}}function VM(i,e,t){let n=new WeakMap,s=new tn;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,d=h!==void 0?h.length:0,u=n.get(a);if(u===void 0||u.count!==d){let k=function(){_.dispose(),n.delete(a),a.removeEventListener("dispose",k)};u!==void 0&&u.texture.dispose();let f=a.morphAttributes.position!==void 0,g=a.morphAttributes.normal!==void 0,y=a.morphAttributes.color!==void 0,p=a.morphAttributes.position||[],m=a.morphAttributes.normal||[],x=a.morphAttributes.color||[],A=0;f===!0&&(A=1),g===!0&&(A=2),y===!0&&(A=3);let S=a.attributes.position.count*A,R=1;S>e.maxTextureSize&&(R=Math.ceil(S/e.maxTextureSize),S=e.maxTextureSize);let M=new Float32Array(S*R*4*d),_=new La(M,S,R,d);_.type=ki,_.needsUpdate=!0;let E=A*4;for(let N=0;N<d;N++){let L=p[N],B=m[N],V=x[N],P=S*R*4*N;for(let F=0;F<L.count;F++){let X=F*E;f===!0&&(s.fromBufferAttribute(L,F),M[P+X+0]=s.x,M[P+X+1]=s.y,M[P+X+2]=s.z,M[P+X+3]=0),g===!0&&(s.fromBufferAttribute(B,F),M[P+X+4]=s.x,M[P+X+5]=s.y,M[P+X+6]=s.z,M[P+X+7]=0),y===!0&&(s.fromBufferAttribute(V,F),M[P+X+8]=s.x,M[P+X+9]=s.y,M[P+X+10]=s.z,M[P+X+11]=V.itemSize===4?s.w:1)}}u={count:d,texture:_,size:new Ze(S,R)},n.set(a,u),a.addEventListener("dispose",k)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,t);else{let f=0;for(let y=0;y<c.length;y++)f+=c[y];let g=a.morphTargetsRelative?1:1-f;l.getUniforms().setValue(i,"morphTargetBaseInfluence",g),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",u.texture,t),l.getUniforms().setValue(i,"morphTargetsTextureSize",u.size)}return{update:r}}function GM(i,e,t,n,s){let r=new WeakMap;function o(c){let h=s.render.frame,d=c.geometry,u=e.get(c,d);if(r.get(u)!==h&&(e.update(u),r.set(u,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(t.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&t.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){let f=c.skeleton;r.get(f)!==h&&(f.update(),r.set(f,h))}return u}function a(){r=new WeakMap}function l(c){let h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),t.remove(h.instanceMatrix),h.instanceColor!==null&&t.remove(h.instanceColor)}return{update:o,dispose:a}}var HM={[Kd]:"LINEAR_TONE_MAPPING",[Jd]:"REINHARD_TONE_MAPPING",[jd]:"CINEON_TONE_MAPPING",[Qd]:"ACES_FILMIC_TONE_MAPPING",[tf]:"AGX_TONE_MAPPING",[nf]:"NEUTRAL_TONE_MAPPING",[ef]:"CUSTOM_TONE_MAPPING"};function WM(i,e,t,n,s,r){let o=new Si(e,t,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,h=new nn;h.setAttribute("position",new Mn([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new Mn([0,2,0,0,2,0],2));let d=new zc({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),u=new Zt(h,d),f=new $a(-1,1,1,-1,0,1),g=null,y=null,p=!1,m,x=null,A=[],S=!1;this.setSize=function(R,M){o.setSize(R,M),a!==null&&a.setSize(R,M),l!==null&&l.setSize(R,M);for(let _=0;_<A.length;_++){let E=A[_];E.setSize&&E.setSize(R,M)}},this.setEffects=function(R){A=R,S=A.length>0&&A[0].isRenderPass===!0;let M=o.width,_=o.height;A.length>0&&a===null&&(a=new Si(M,_,{type:es,depthBuffer:!1,stencilBuffer:!1}),l=new Si(M,_,{type:es,depthBuffer:!1,stencilBuffer:!1}));let E=s===!0&&A.some(k=>k.needsDepthTexture===!0);E!==(o.depthTexture!==null)&&(E===!0&&c===null&&(c=new Us(M,_),r===!0&&(c.format=Bs,c.type=Ur)),o.dispose(),o.depthTexture=E?c:null,o.resolveDepthBuffer=E,o.storeMultisampledDepthBuffer=E);for(let k=0;k<A.length;k++){let N=A[k];N.setSize&&N.setSize(M,_),E&&N.needsDepthTexture===!0&&N.setDepthTexture&&N.setDepthTexture(c)}},this.begin=function(R,M){if(p||R.toneMapping===Oi&&A.length===0)return!1;if(x=M,M!==null){let _=M.width,E=M.height;(o.width!==_||o.height!==E)&&this.setSize(_,E)}return S===!1&&R.setRenderTarget(o),m=R.toneMapping,R.toneMapping=Oi,!0},this.hasRenderPass=function(){return S},this.end=function(R,M){R.toneMapping=m,p=!0;let _=o,E=a;for(let k=0;k<A.length;k++){let N=A[k];N.enabled!==!1&&(N.render(R,E,_,M),N.needsSwap!==!1&&(_=E,E=E===a?l:a))}if(g!==R.outputColorSpace||y!==R.toneMapping){g=R.outputColorSpace,y=R.toneMapping,d.defines={},vt.getTransfer(g)===Ct&&(d.defines.SRGB_TRANSFER="");let k=HM[y];k&&(d.defines[k]=""),d.needsUpdate=!0}d.uniforms.tDiffuse.value=_.texture,R.setRenderTarget(x),R.render(u,f),x=null,p=!1},this.isCompositing=function(){return p},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),h.dispose(),d.dispose()}}var A0=new hi,R0=new Us(1,1),C0=new za(1),P0=new La,I0=new Uc,L0=new Ba,o0=[],a0=[],l0=new Float32Array(16),c0=new Float32Array(9),h0=new Float32Array(4);function Ho(i,e,t){let n=i[0];if(n<=0||n>0)return i;let s=e*t,r=o0[s];if(r===void 0&&(r=new Float32Array(s),o0[s]=r),e!==0){n.toArray(r,0);for(let o=1,a=0;o!==e;++o)a+=t,i[o].toArray(r,a)}return r}function Cn(i,e){if(i.length!==e.length)return!1;for(let t=0,n=i.length;t<n;t++)if(i[t]!==e[t])return!1;return!0}function Pn(i,e){for(let t=0,n=e.length;t<n;t++)i[t]=e[t]}function $h(i,e){let t=a0[e];t===void 0&&(t=new Int32Array(e),a0[e]=t);for(let n=0;n!==e;++n)t[n]=i.allocateTextureUnit();return t}function XM(i,e){let t=this.cache;t[0]!==e&&(i.uniform1f(this.addr,e),t[0]=e)}function qM(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2f(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Cn(t,e))return;i.uniform2fv(this.addr,e),Pn(t,e)}}function $M(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3f(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else if(e.r!==void 0)(t[0]!==e.r||t[1]!==e.g||t[2]!==e.b)&&(i.uniform3f(this.addr,e.r,e.g,e.b),t[0]=e.r,t[1]=e.g,t[2]=e.b);else{if(Cn(t,e))return;i.uniform3fv(this.addr,e),Pn(t,e)}}function YM(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4f(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Cn(t,e))return;i.uniform4fv(this.addr,e),Pn(t,e)}}function ZM(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(Cn(t,e))return;i.uniformMatrix2fv(this.addr,!1,e),Pn(t,e)}else{if(Cn(t,n))return;h0.set(n),i.uniformMatrix2fv(this.addr,!1,h0),Pn(t,n)}}function KM(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(Cn(t,e))return;i.uniformMatrix3fv(this.addr,!1,e),Pn(t,e)}else{if(Cn(t,n))return;c0.set(n),i.uniformMatrix3fv(this.addr,!1,c0),Pn(t,n)}}function JM(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(Cn(t,e))return;i.uniformMatrix4fv(this.addr,!1,e),Pn(t,e)}else{if(Cn(t,n))return;l0.set(n),i.uniformMatrix4fv(this.addr,!1,l0),Pn(t,n)}}function jM(i,e){let t=this.cache;t[0]!==e&&(i.uniform1i(this.addr,e),t[0]=e)}function QM(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2i(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Cn(t,e))return;i.uniform2iv(this.addr,e),Pn(t,e)}}function ew(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3i(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(Cn(t,e))return;i.uniform3iv(this.addr,e),Pn(t,e)}}function tw(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4i(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Cn(t,e))return;i.uniform4iv(this.addr,e),Pn(t,e)}}function nw(i,e){let t=this.cache;t[0]!==e&&(i.uniform1ui(this.addr,e),t[0]=e)}function iw(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2ui(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(Cn(t,e))return;i.uniform2uiv(this.addr,e),Pn(t,e)}}function sw(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3ui(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(Cn(t,e))return;i.uniform3uiv(this.addr,e),Pn(t,e)}}function rw(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4ui(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(Cn(t,e))return;i.uniform4uiv(this.addr,e),Pn(t,e)}}function Yh(i){return i.version===0&&(i.compareFunction=ff,i.needsUpdate=!0),i}function ow(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=Yh(R0):r=A0,t.setTexture2D(e||r,s)}function aw(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),t.setTexture3D(e||I0,s)}function lw(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=Yh(C0):r=L0,t.setTextureCube(e||r,s)}function cw(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),t.setTexture2DArray(e||P0,s)}function hw(i){switch(i){case 5126:return XM;case 35664:return qM;case 35665:return $M;case 35666:return YM;case 35674:return ZM;case 35675:return KM;case 35676:return JM;case 5124:case 35670:return jM;case 35667:case 35671:return QM;case 35668:case 35672:return ew;case 35669:case 35673:return tw;case 5125:return nw;case 36294:return iw;case 36295:return sw;case 36296:return rw;case 35678:case 36198:case 36298:case 36306:case 35682:return ow;case 35679:case 36299:case 36307:return aw;case 35680:case 36300:case 36308:case 36293:return lw;case 36289:case 36303:case 36311:case 36292:return cw}}function uw(i,e){i.uniform1fv(this.addr,e)}function dw(i,e){let t=Ho(e,this.size,2);i.uniform2fv(this.addr,t)}function fw(i,e){let t=Ho(e,this.size,3);i.uniform3fv(this.addr,t)}function pw(i,e){let t=Ho(e,this.size,4);i.uniform4fv(this.addr,t)}function mw(i,e){let t=Ho(e,this.size,4);i.uniformMatrix2fv(this.addr,!1,t)}function gw(i,e){let t=Ho(e,this.size,9);i.uniformMatrix3fv(this.addr,!1,t)}function yw(i,e){let t=Ho(e,this.size,16);i.uniformMatrix4fv(this.addr,!1,t)}function _w(i,e){i.uniform1iv(this.addr,e)}function vw(i,e){i.uniform2iv(this.addr,e)}function xw(i,e){i.uniform3iv(this.addr,e)}function bw(i,e){i.uniform4iv(this.addr,e)}function Sw(i,e){i.uniform1uiv(this.addr,e)}function Mw(i,e){i.uniform2uiv(this.addr,e)}function ww(i,e){i.uniform3uiv(this.addr,e)}function Tw(i,e){i.uniform4uiv(this.addr,e)}function Ew(i,e,t){let n=this.cache,s=e.length,r=$h(t,s);Cn(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=Yh(R0):o=A0;for(let a=0;a!==s;++a)t.setTexture2D(e[a]||o,r[a])}function Aw(i,e,t){let n=this.cache,s=e.length,r=$h(t,s);Cn(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));for(let o=0;o!==s;++o)t.setTexture3D(e[o]||I0,r[o])}function Rw(i,e,t){let n=this.cache,s=e.length,r=$h(t,s);Cn(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=Yh(C0):o=L0;for(let a=0;a!==s;++a)t.setTextureCube(e[a]||o,r[a])}function Cw(i,e,t){let n=this.cache,s=e.length,r=$h(t,s);Cn(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));for(let o=0;o!==s;++o)t.setTexture2DArray(e[o]||P0,r[o])}function Pw(i){switch(i){case 5126:return uw;case 35664:return dw;case 35665:return fw;case 35666:return pw;case 35674:return mw;case 35675:return gw;case 35676:return yw;case 5124:case 35670:return _w;case 35667:case 35671:return vw;case 35668:case 35672:return xw;case 35669:case 35673:return bw;case 5125:return Sw;case 36294:return Mw;case 36295:return ww;case 36296:return Tw;case 35678:case 36198:case 36298:case 36306:case 35682:return Ew;case 35679:case 36299:case 36307:return Aw;case 35680:case 36300:case 36308:case 36293:return Rw;case 36289:case 36303:case 36311:case 36292:return Cw}}var Ef=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.setValue=hw(t.type)}},Af=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.size=t.size,this.setValue=Pw(t.type)}},Rf=class{constructor(e){this.id=e,this.seq=[],this.map={}}setValue(e,t,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(e,t[a.id],n)}}},wf=/(\w+)(\])?(\[|\.)?/g;function u0(i,e){i.seq.push(e),i.map[e.id]=e}function Iw(i,e,t){let n=i.name,s=n.length;for(wf.lastIndex=0;;){let r=wf.exec(n),o=wf.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){u0(t,c===void 0?new Ef(a,i,e):new Af(a,i,e));break}else{let d=t.map[a];d===void 0&&(d=new Rf(a),u0(t,d)),t=d}}}var Go=class{constructor(e,t){this.seq=[],this.map={};let n=e.getProgramParameter(t,e.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=e.getActiveUniform(t,o),l=e.getUniformLocation(t,a.name);Iw(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===e.SAMPLER_2D_SHADOW||o.type===e.SAMPLER_CUBE_SHADOW||o.type===e.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(e,t,n,s){let r=this.map[t];r!==void 0&&r.setValue(e,n,s)}setOptional(e,t,n){let s=t[n];s!==void 0&&this.setValue(e,n,s)}static upload(e,t,n,s){for(let r=0,o=t.length;r!==o;++r){let a=t[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(e,l.value,s)}}static seqWithValue(e,t){let n=[];for(let s=0,r=e.length;s!==r;++s){let o=e[s];o.id in t&&n.push(o)}return n}};function d0(i,e,t){let n=i.createShader(e);return i.shaderSource(n,t),i.compileShader(n),n}var Lw=37297,Nw=0;function Dw(i,e){let t=i.split(`
`),n=[],s=Math.max(e-6,0),r=Math.min(e+6,t.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===e?">":" "} ${a}: ${t[o]}`)}return n.join(`
`)}var f0=new st;function Fw(i){vt._getMatrix(f0,vt.workingColorSpace,i);let e=`mat3( ${f0.elements.map(t=>t.toFixed(4))} )`;switch(vt.getTransfer(i)){case Pa:return[e,"LinearTransferOETF"];case Ct:return[e,"sRGBTransferOETF"];default:return Ye("WebGLProgram: Unsupported color space: ",i),[e,"LinearTransferOETF"]}}function p0(i,e,t){let n=i.getShaderParameter(e,i.COMPILE_STATUS),r=(i.getShaderInfoLog(e)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return t.toUpperCase()+`

`+r+`

`+Dw(i.getShaderSource(e),a)}else return r}function Uw(i,e){let t=Fw(e);return[`vec4 ${i}( vec4 value ) {`,`	return ${t[1]}( vec4( ${t[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var Ow={[Kd]:"Linear",[Jd]:"Reinhard",[jd]:"Cineon",[Qd]:"ACESFilmic",[tf]:"AgX",[nf]:"Neutral",[ef]:"Custom"};function kw(i,e){let t=Ow[e];return t===void 0?(Ye("WebGLProgram: Unsupported toneMapping:",e),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+t+"ToneMapping( color ); }"}var Wh=new W;function Bw(){vt.getLuminanceCoefficients(Wh);let i=Wh.x.toFixed(4),e=Wh.y.toFixed(4),t=Wh.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${e}, ${t} );`,"	return dot( weights, rgb );","}"].join(`
`)}function zw(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(rl).join(`
`)}function Vw(i){let e=[];for(let t in i){let n=i[t];n!==!1&&e.push("#define "+t+" "+n)}return e.join(`
`)}function Gw(i,e){let t={},n=i.getProgramParameter(e,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(e,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),t[o]={type:r.type,location:i.getAttribLocation(e,o),locationSize:a}}return t}function rl(i){return i!==""}function m0(i,e){let t=e.numSpotLightShadows+e.numSpotLightMaps-e.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,e.numSunLights).replace(/NUM_DIR_LIGHTS/g,e.numDirLights).replace(/NUM_SPOT_LIGHTS/g,e.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,e.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,t).replace(/NUM_RECT_AREA_LIGHTS/g,e.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,e.numPointLights).replace(/NUM_HEMI_LIGHTS/g,e.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,e.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,e.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,e.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,e.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,e.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,e.numLightProbeGrids)}function g0(i,e){return i.replace(/NUM_CLIPPING_PLANES/g,e.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,e.numClippingPlanes-e.numClipIntersection)}var Hw=/^[ \t]*#include +<([\w\d./]+)>/gm;function Cf(i){return i.replace(Hw,Ww)}function Ww(i,e){let t=dt[e];if(t===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+e+">");return Cf(t)}var Xw=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function y0(i){return i.replace(Xw,qw)}function qw(i,e,t,n){let s="";for(let r=parseInt(e);r<parseInt(t);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function _0(i){let e=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?e+=`
#define HIGH_PRECISION`:i.precision==="mediump"?e+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(e+=`
#define LOW_PRECISION`),e}var $w={[Lr]:"SHADOWMAP_TYPE_PCF",[Oo]:"SHADOWMAP_TYPE_VSM"};function Yw(i){return $w[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var Zw={[Bo]:"ENVMAP_MODE_REFRACTION"};function Kw(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":Zw[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var Jw={[th]:"ENVMAP_BLENDING_MULTIPLY",[Dg]:"ENVMAP_BLENDING_MIX",[Fg]:"ENVMAP_BLENDING_ADD"};function jw(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":Jw[i.combine]||"ENVMAP_BLENDING_NONE"}function Qw(i,e,t,n){let s=i.getContext(),r=t.defines,o=t.vertexShader,a=t.fragmentShader,l=Yw(t),c=t.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=Kw(t),d=jw(t),u=zw(t),f=Vw(r),g=s.createProgram(),y,p,m=t.glslVersion?"#version "+t.glslVersion+`
`:"";t.isRawShaderMaterial?(y=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f].filter(rl).join(`
`),y.length>0&&(y+=`
`),p=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f].filter(rl).join(`
`),p.length>0&&(p+=`
`)):(y=[_0(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f,t.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",t.batching?"#define USE_BATCHING":"",t.batchingColor?"#define USE_BATCHING_COLOR":"",t.instancing?"#define USE_INSTANCING":"",t.instancingColor?"#define USE_INSTANCING_COLOR":"",t.instancingMorph?"#define USE_INSTANCING_MORPH":"",t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.map?"#define USE_MAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+h:"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.displacementMap?"#define USE_DISPLACEMENTMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.mapUv?"#define MAP_UV "+t.mapUv:"",t.alphaMapUv?"#define ALPHAMAP_UV "+t.alphaMapUv:"",t.lightMapUv?"#define LIGHTMAP_UV "+t.lightMapUv:"",t.aoMapUv?"#define AOMAP_UV "+t.aoMapUv:"",t.emissiveMapUv?"#define EMISSIVEMAP_UV "+t.emissiveMapUv:"",t.bumpMapUv?"#define BUMPMAP_UV "+t.bumpMapUv:"",t.normalMapUv?"#define NORMALMAP_UV "+t.normalMapUv:"",t.displacementMapUv?"#define DISPLACEMENTMAP_UV "+t.displacementMapUv:"",t.metalnessMapUv?"#define METALNESSMAP_UV "+t.metalnessMapUv:"",t.roughnessMapUv?"#define ROUGHNESSMAP_UV "+t.roughnessMapUv:"",t.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+t.anisotropyMapUv:"",t.clearcoatMapUv?"#define CLEARCOATMAP_UV "+t.clearcoatMapUv:"",t.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+t.clearcoatNormalMapUv:"",t.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+t.clearcoatRoughnessMapUv:"",t.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+t.diffuseRoughnessMapUv:"",t.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+t.iridescenceMapUv:"",t.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+t.iridescenceThicknessMapUv:"",t.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+t.sheenColorMapUv:"",t.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+t.sheenRoughnessMapUv:"",t.specularMapUv?"#define SPECULARMAP_UV "+t.specularMapUv:"",t.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+t.specularColorMapUv:"",t.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+t.specularIntensityMapUv:"",t.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+t.transmissionMapUv:"",t.thicknessMapUv?"#define THICKNESSMAP_UV "+t.thicknessMapUv:"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexNormals?"#define HAS_NORMAL":"",t.vertexColors?"#define USE_COLOR":"",t.vertexAlphas?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.flatShading?"#define FLAT_SHADED":"",t.skinning?"#define USE_SKINNING":"",t.morphTargets?"#define USE_MORPHTARGETS":"",t.morphNormals&&t.flatShading===!1?"#define USE_MORPHNORMALS":"",t.morphColors?"#define USE_MORPHCOLORS":"",t.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+t.morphTextureStride:"",t.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+t.morphTargetsCount:"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.sizeAttenuation?"#define USE_SIZEATTENUATION":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(rl).join(`
`),p=[_0(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,f,t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",t.map?"#define USE_MAP":"",t.matcap?"#define USE_MATCAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+c:"",t.envMap?"#define "+h:"",t.envMap?"#define "+d:"",t.envMapPMREM?"#define ENVMAP_MAX_LOD "+t.envMapMaxLod+".0":"",t.envMapPMREM?"#define ENVMAP_SIZE "+t.envMapSize+".0":"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoat?"#define USE_CLEARCOAT":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.dispersion?"#define USE_DISPERSION":"",t.retroreflection?"#define USE_RETROREFLECTION":"",t.iridescence?"#define USE_IRIDESCENCE":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaTest?"#define USE_ALPHATEST":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.sheen?"#define USE_SHEEN":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexColors||t.instancingColor?"#define USE_COLOR":"",t.vertexAlphas||t.batchingColor?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.gradientMap?"#define USE_GRADIENTMAP":"",t.flatShading?"#define FLAT_SHADED":"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",t.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",t.toneMapping!==Oi?"#define TONE_MAPPING":"",t.toneMapping!==Oi?dt.tonemapping_pars_fragment:"",t.toneMapping!==Oi?kw("toneMapping",t.toneMapping):"",t.dithering?"#define DITHERING":"",t.opaque?"#define OPAQUE":"",dt.colorspace_pars_fragment,Uw("linearToOutputTexel",t.outputColorSpace),Bw(),t.useDepthPacking?"#define DEPTH_PACKING "+t.depthPacking:"",`
`].filter(rl).join(`
`)),o=Cf(o),o=m0(o,t),o=g0(o,t),a=Cf(a),a=m0(a,t),a=g0(a,t),o=y0(o),a=y0(a),t.isRawShaderMaterial!==!0&&(m=`#version 300 es
`,y=[u,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+y,p=["#define varying in",t.glslVersion===pf?"":"layout(location = 0) out highp vec4 pc_fragColor;",t.glslVersion===pf?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+p);let x=m+y+o,A=m+p+a,S=d0(s,s.VERTEX_SHADER,x),R=d0(s,s.FRAGMENT_SHADER,A);s.attachShader(g,S),s.attachShader(g,R),t.index0AttributeName!==void 0?s.bindAttribLocation(g,0,t.index0AttributeName):t.hasPositionAttribute===!0&&s.bindAttribLocation(g,0,"position"),s.linkProgram(g);function M(N){if(i.debug.checkShaderErrors){let L=s.getProgramInfoLog(g)||"",B=s.getShaderInfoLog(S)||"",V=s.getShaderInfoLog(R)||"",P=L.trim(),F=B.trim(),X=V.trim(),G=!0,oe=!0;if(s.getProgramParameter(g,s.LINK_STATUS)===!1)if(G=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,g,S,R);else{let $=p0(s,S,"vertex"),J=p0(s,R,"fragment");tt("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(g,s.VALIDATE_STATUS)+`

Material Name: `+N.name+`
Material Type: `+N.type+`

Program Info Log: `+P+`
`+$+`
`+J)}else P!==""?Ye("WebGLProgram: Program Info Log:",P):(F===""||X==="")&&(oe=!1);oe&&(N.diagnostics={runnable:G,programLog:P,vertexShader:{log:F,prefix:y},fragmentShader:{log:X,prefix:p}})}s.deleteShader(S),s.deleteShader(R),_=new Go(s,g),E=Gw(s,g)}let _;this.getUniforms=function(){return _===void 0&&M(this),_};let E;this.getAttributes=function(){return E===void 0&&M(this),E};let k=t.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return k===!1&&(k=s.getProgramParameter(g,Lw)),k},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(g),this.program=void 0},this.type=t.shaderType,this.name=t.shaderName,this.id=Nw++,this.cacheKey=e,this.usedTimes=1,this.program=g,this.vertexShader=S,this.fragmentShader=R,this}var e1=0,Pf=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(e,t,n){let s=this._getShaderCacheForMaterial(e);return s.has(t)===!1&&(s.add(t),t.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(e){let t=this.materialCache.get(e);for(let n of t)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(e),this}getVertexShaderStage(e){return this._getShaderStage(e.vertexShader)}getFragmentShaderStage(e){return this._getShaderStage(e.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(e){let t=this.materialCache,n=t.get(e);return n===void 0&&(n=new Set,t.set(e,n)),n}_getShaderStage(e){let t=this.shaderCache,n=t.get(e);return n===void 0&&(n=new If(e),t.set(e,n)),n}},If=class{constructor(e){this.id=e1++,this.code=e,this.usedTimes=0}};function t1(i){return i===dr||i===nl||i===il}function n1(i,e,t,n,s,r){let o=new Ro,a=new Pf,l=new Set,c=[],h=new Map,d=n.logarithmicDepthBuffer,u={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function f(_){return l.add(_),_===0?"uv":`uv${_}`}function g(_,E,k,N,L,B){let V=N.fog,P=L.geometry,F=_.isMeshStandardMaterial||_.isMeshLambertMaterial||_.isMeshPhongMaterial?N.environment:null,X=_.isMeshStandardMaterial||_.isMeshLambertMaterial&&!_.envMap||_.isMeshPhongMaterial&&!_.envMap,G=e.get(_.envMap||F,X),oe=u[_.type],$=n.precision;_.precision!==null&&($=n.getMaxPrecision(_.precision),$!==_.precision&&Ye("WebGLProgram.getParameters:",_.precision,"not supported, using",$,"instead."));let J=P.morphAttributes.position||P.morphAttributes.normal||P.morphAttributes.color,ne=J!==void 0?J.length:0,ue=0;P.morphAttributes.position!==void 0&&(ue=1),P.morphAttributes.normal!==void 0&&(ue=2),P.morphAttributes.color!==void 0&&(ue=3);let ce,Q,pe,me;if(oe){let Re=vs[oe];ce=Re.vertexShader,Q=Re.fragmentShader}else{ce=_.vertexShader,Q=_.fragmentShader;let Re=a.getVertexShaderStage(_),ht=a.getFragmentShaderStage(_);a.update(_,Re,ht),pe=Re.id,me=ht.id}let ye=i.getRenderTarget(),ge=i.state.buffers.depth.getReversed(),Ve=L.isInstancedMesh===!0,Je=L.isBatchedMesh===!0,Ue=!!_.map,rt=!!_.matcap,ct=!!G,ot=ct&&G.isPMREMTexture===!0,jt=!!_.aoMap,Gt=!!_.lightMap,pn=!!_.bumpMap&&_.wireframe===!1,Dt=!!_.normalMap,Dn=!!_.displacementMap,bt=!!_.emissiveMap,Tn=!!_.metalnessMap,rn=!!_.roughnessMap,mn=_.anisotropy>0,O=_.clearcoat>0,Ce=_.diffuseRoughness>0,Ke=_.dispersion>0,lt=_.retroreflectivity>0,we=_.iridescence>0,Ot=_.sheen>0,Ge=_.transmission>0,qe=mn&&!!_.anisotropyMap,C=O&&!!_.clearcoatMap,b=O&&!!_.clearcoatNormalMap,q=O&&!!_.clearcoatRoughnessMap,he=Ce&&!!_.diffuseRoughnessMap,re=we&&!!_.iridescenceMap,ve=we&&!!_.iridescenceThicknessMap,xe=Ot&&!!_.sheenColorMap,ee=Ot&&!!_.sheenRoughnessMap,ie=!!_.specularMap,fe=!!_.specularColorMap,U=!!_.specularIntensityMap,se=Ge&&!!_.transmissionMap,te=Ge&&!!_.thicknessMap,Te=!!_.gradientMap,_e=!!_.alphaMap,Me=_.alphaTest>0,He=!!_.alphaHash,Qe=!!_.extensions,le=Oi;_.toneMapped&&(ye===null||ye.isXRRenderTarget===!0)&&(le=i.toneMapping);let ke=ot?G.isCompressedCubeTexture?G.image[0].mipmaps:G.mipmaps:null,et={shaderID:oe,shaderType:_.type,shaderName:_.name,vertexShader:ce,fragmentShader:Q,defines:_.defines,customVertexShaderID:pe,customFragmentShaderID:me,isRawShaderMaterial:_.isRawShaderMaterial===!0,glslVersion:_.glslVersion,precision:$,batching:Je,batchingColor:Je&&L._colorsTexture!==null,instancing:Ve,instancingColor:Ve&&L.instanceColor!==null,instancingMorph:Ve&&L.morphTexture!==null,outputColorSpace:ye===null?i.outputColorSpace:ye.isXRRenderTarget===!0?ye.texture.colorSpace:vt.workingColorSpace,alphaToCoverage:!!_.alphaToCoverage,map:Ue,matcap:rt,envMap:ct,envMapMode:ct&&G.mapping,envMapPMREM:ot,envMapMaxLod:ot?ke.length-1:null,envMapSize:ot?ke[0].width:null,aoMap:jt,lightMap:Gt,bumpMap:pn,normalMap:Dt,displacementMap:Dn,emissiveMap:bt,normalMapObjectSpace:Dt&&_.normalMapType===kg,normalMapTangentSpace:Dt&&_.normalMapType===Gh,packedNormalMap:Dt&&_.normalMapType===Gh&&t1(_.normalMap.format),metalnessMap:Tn,roughnessMap:rn,anisotropy:mn,anisotropyMap:qe,clearcoat:O,clearcoatMap:C,clearcoatNormalMap:b,clearcoatRoughnessMap:q,diffuseRoughness:Ce,diffuseRoughnessMap:he,dispersion:Ke,retroreflection:lt,iridescence:we,iridescenceMap:re,iridescenceThicknessMap:ve,sheen:Ot,sheenColorMap:xe,sheenRoughnessMap:ee,specularMap:ie,specularColorMap:fe,specularIntensityMap:U,transmission:Ge,transmissionMap:se,thicknessMap:te,gradientMap:Te,opaque:_.transparent===!1&&_.blending===ko&&_.alphaToCoverage===!1,alphaMap:_e,alphaTest:Me,alphaHash:He,combine:_.combine,mapUv:Ue&&f(_.map.channel),aoMapUv:jt&&f(_.aoMap.channel),lightMapUv:Gt&&f(_.lightMap.channel),bumpMapUv:pn&&f(_.bumpMap.channel),normalMapUv:Dt&&f(_.normalMap.channel),displacementMapUv:Dn&&f(_.displacementMap.channel),emissiveMapUv:bt&&f(_.emissiveMap.channel),metalnessMapUv:Tn&&f(_.metalnessMap.channel),roughnessMapUv:rn&&f(_.roughnessMap.channel),anisotropyMapUv:qe&&f(_.anisotropyMap.channel),clearcoatMapUv:C&&f(_.clearcoatMap.channel),clearcoatNormalMapUv:b&&f(_.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:q&&f(_.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:he&&f(_.diffuseRoughnessMap.channel),iridescenceMapUv:re&&f(_.iridescenceMap.channel),iridescenceThicknessMapUv:ve&&f(_.iridescenceThicknessMap.channel),sheenColorMapUv:xe&&f(_.sheenColorMap.channel),sheenRoughnessMapUv:ee&&f(_.sheenRoughnessMap.channel),specularMapUv:ie&&f(_.specularMap.channel),specularColorMapUv:fe&&f(_.specularColorMap.channel),specularIntensityMapUv:U&&f(_.specularIntensityMap.channel),transmissionMapUv:se&&f(_.transmissionMap.channel),thicknessMapUv:te&&f(_.thicknessMap.channel),alphaMapUv:_e&&f(_.alphaMap.channel),vertexTangents:!!P.attributes.tangent&&(Dt||mn),vertexNormals:!!P.attributes.normal,vertexColors:_.vertexColors,vertexAlphas:_.vertexColors===!0&&!!P.attributes.color&&P.attributes.color.itemSize===4,pointsUvs:L.isPoints===!0&&!!P.attributes.uv&&(Ue||_e),fog:!!V,useFog:_.fog===!0,fogExp2:!!V&&V.isFogExp2,flatShading:_.wireframe===!1&&(_.flatShading===!0||P.attributes.normal===void 0&&Dt===!1&&(_.isMeshLambertMaterial||_.isMeshPhongMaterial||_.isMeshStandardMaterial||_.isMeshPhysicalMaterial)),sizeAttenuation:_.sizeAttenuation===!0,logarithmicDepthBuffer:d,reversedDepthBuffer:ge,skinning:L.isSkinnedMesh===!0,hasPositionAttribute:P.attributes.position!==void 0,morphTargets:P.morphAttributes.position!==void 0,morphNormals:P.morphAttributes.normal!==void 0,morphColors:P.morphAttributes.color!==void 0,morphTargetsCount:ne,morphTextureStride:ue,numSunLights:E.sun.length,numDirLights:E.directional.length,numPointLights:E.point.length,numSpotLights:E.spot.length,numSpotLightMaps:E.spotLightMap.length,numRectAreaLights:E.rectArea.length,numHemiLights:E.hemi.length,numSunLightShadows:E.sunShadowMap.length,numDirLightShadows:E.directionalShadowMap.length,numPointLightShadows:E.pointShadowMap.length,numSpotLightShadows:E.spotShadowMap.length,numSpotLightShadowsWithMaps:E.numSpotLightShadowsWithMaps,numLightProbes:E.numLightProbes,numLightProbeGrids:B.filter(Re=>Re.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:_.dithering,shadowMapEnabled:i.shadowMap.enabled&&k.length>0,shadowMapType:i.shadowMap.type,toneMapping:le,decodeVideoTexture:Ue&&_.map.isVideoTexture===!0&&vt.getTransfer(_.map.colorSpace)===Ct,decodeVideoTextureEmissive:bt&&_.emissiveMap.isVideoTexture===!0&&vt.getTransfer(_.emissiveMap.colorSpace)===Ct,premultipliedAlpha:_.premultipliedAlpha,doubleSided:_.side===Kn,flipSided:_.side===ai,useDepthPacking:_.depthPacking>=0,depthPacking:_.depthPacking||0,index0AttributeName:_.index0AttributeName,extensionClipCullDistance:Qe&&_.extensions.clipCullDistance===!0&&t.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(Qe&&_.extensions.multiDraw===!0||Je)&&t.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:t.has("KHR_parallel_shader_compile"),customProgramCacheKey:_.customProgramCacheKey()};return et.vertexUv1s=l.has(1),et.vertexUv2s=l.has(2),et.vertexUv3s=l.has(3),l.clear(),et}function y(_){let E=[];if(_.shaderID?E.push(_.shaderID):(E.push(_.customVertexShaderID),E.push(_.customFragmentShaderID)),_.defines!==void 0)for(let k in _.defines)E.push(k),E.push(_.defines[k]);return _.isRawShaderMaterial===!1&&(p(E,_),m(E,_),E.push(i.outputColorSpace)),E.push(_.customProgramCacheKey),E.join()}function p(_,E){_.push(E.precision),_.push(E.outputColorSpace),_.push(E.envMapMode),_.push(E.envMapPMREM),_.push(E.envMapMaxLod),_.push(E.envMapSize),_.push(E.mapUv),_.push(E.alphaMapUv),_.push(E.lightMapUv),_.push(E.aoMapUv),_.push(E.bumpMapUv),_.push(E.normalMapUv),_.push(E.displacementMapUv),_.push(E.emissiveMapUv),_.push(E.metalnessMapUv),_.push(E.roughnessMapUv),_.push(E.anisotropyMapUv),_.push(E.clearcoatMapUv),_.push(E.clearcoatNormalMapUv),_.push(E.clearcoatRoughnessMapUv),_.push(E.diffuseRoughnessMapUv),_.push(E.iridescenceMapUv),_.push(E.iridescenceThicknessMapUv),_.push(E.sheenColorMapUv),_.push(E.sheenRoughnessMapUv),_.push(E.specularMapUv),_.push(E.specularColorMapUv),_.push(E.specularIntensityMapUv),_.push(E.transmissionMapUv),_.push(E.thicknessMapUv),_.push(E.combine),_.push(E.fogExp2),_.push(E.sizeAttenuation),_.push(E.morphTargetsCount),_.push(E.numSunLights),_.push(E.numDirLights),_.push(E.numPointLights),_.push(E.numSpotLights),_.push(E.numSpotLightMaps),_.push(E.numHemiLights),_.push(E.numRectAreaLights),_.push(E.numSunLightShadows),_.push(E.numDirLightShadows),_.push(E.numPointLightShadows),_.push(E.numSpotLightShadows),_.push(E.numSpotLightShadowsWithMaps),_.push(E.numLightProbes),_.push(E.numLightProbeGrids),_.push(E.shadowMapType),_.push(E.toneMapping),_.push(E.numClippingPlanes),_.push(E.numClipIntersection),_.push(E.depthPacking)}function m(_,E){o.disableAll(),E.instancing&&o.enable(0),E.instancingColor&&o.enable(1),E.instancingMorph&&o.enable(2),E.matcap&&o.enable(3),E.envMap&&o.enable(4),E.normalMapObjectSpace&&o.enable(5),E.normalMapTangentSpace&&o.enable(6),E.clearcoat&&o.enable(7),E.iridescence&&o.enable(8),E.alphaTest&&o.enable(9),E.vertexColors&&o.enable(10),E.vertexAlphas&&o.enable(11),E.vertexUv1s&&o.enable(12),E.vertexUv2s&&o.enable(13),E.vertexUv3s&&o.enable(14),E.vertexTangents&&o.enable(15),E.anisotropy&&o.enable(16),E.alphaHash&&o.enable(17),E.batching&&o.enable(18),E.dispersion&&o.enable(19),E.retroreflection&&o.enable(24),E.diffuseRoughness&&o.enable(25),E.batchingColor&&o.enable(20),E.gradientMap&&o.enable(21),E.packedNormalMap&&o.enable(22),E.vertexNormals&&o.enable(23),_.push(o.mask),o.disableAll(),E.fog&&o.enable(0),E.useFog&&o.enable(1),E.flatShading&&o.enable(2),E.logarithmicDepthBuffer&&o.enable(3),E.reversedDepthBuffer&&o.enable(4),E.skinning&&o.enable(5),E.morphTargets&&o.enable(6),E.morphNormals&&o.enable(7),E.morphColors&&o.enable(8),E.premultipliedAlpha&&o.enable(9),E.shadowMapEnabled&&o.enable(10),E.doubleSided&&o.enable(11),E.flipSided&&o.enable(12),E.useDepthPacking&&o.enable(13),E.dithering&&o.enable(14),E.transmission&&o.enable(15),E.sheen&&o.enable(16),E.opaque&&o.enable(17),E.pointsUvs&&o.enable(18),E.decodeVideoTexture&&o.enable(19),E.decodeVideoTextureEmissive&&o.enable(20),E.alphaToCoverage&&o.enable(21),E.numLightProbeGrids>0&&o.enable(22),E.hasPositionAttribute&&o.enable(23),_.push(o.mask)}function x(_){let E=u[_.type],k;if(E){let N=vs[E];k=Qg.clone(N.uniforms)}else k=_.uniforms;return k}function A(_,E){let k=h.get(E);return k!==void 0?++k.usedTimes:(k=new Qw(i,E,_,s),c.push(k),h.set(E,k)),k}function S(_){if(--_.usedTimes===0){let E=c.indexOf(_);c[E]=c[c.length-1],c.pop(),h.delete(_.cacheKey),_.destroy()}}function R(_){a.remove(_)}function M(){a.dispose()}return{getParameters:g,getProgramCacheKey:y,getUniforms:x,acquireProgram:A,releaseProgram:S,releaseShaderCache:R,programs:c,dispose:M}}function i1(){let i=new WeakMap;function e(o){return i.has(o)}function t(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:e,get:t,remove:n,update:s,dispose:r}}function s1(i,e){return i.groupOrder!==e.groupOrder?i.groupOrder-e.groupOrder:i.renderOrder!==e.renderOrder?i.renderOrder-e.renderOrder:i.material.id!==e.material.id?i.material.id-e.material.id:i.materialVariant!==e.materialVariant?i.materialVariant-e.materialVariant:i.z!==e.z?i.z-e.z:i.id-e.id}function v0(i,e){return i.groupOrder!==e.groupOrder?i.groupOrder-e.groupOrder:i.renderOrder!==e.renderOrder?i.renderOrder-e.renderOrder:i.z!==e.z?e.z-i.z:i.id-e.id}function x0(){let i=[],e=0,t=[],n=[],s=[];function r(){e=0,t.length=0,n.length=0,s.length=0}function o(u){let f=0;return u.isInstancedMesh&&(f+=2),u.isSkinnedMesh&&(f+=1),f}function a(u,f,g,y,p,m){let x=i[e];return x===void 0?(x={id:u.id,object:u,geometry:f,material:g,materialVariant:o(u),groupOrder:y,renderOrder:u.renderOrder,z:p,group:m},i[e]=x):(x.id=u.id,x.object=u,x.geometry=f,x.material=g,x.materialVariant=o(u),x.groupOrder=y,x.renderOrder=u.renderOrder,x.z=p,x.group=m),e++,x}function l(u,f,g,y,p,m,x){x.reversedDepth===!0&&(p=-p);let A=a(u,f,g,y,p,m);g.transmission>0?n.push(A):g.transparent===!0?s.push(A):t.push(A)}function c(u,f,g,y,p,m){let x=a(u,f,g,y,p,m);g.transmission>0?n.unshift(x):g.transparent===!0?s.unshift(x):t.unshift(x)}function h(u,f){t.length>1&&t.sort(u||s1),n.length>1&&n.sort(f||v0),s.length>1&&s.sort(f||v0)}function d(){for(let u=e,f=i.length;u<f;u++){let g=i[u];if(g.id===null)break;g.id=null,g.object=null,g.geometry=null,g.material=null,g.group=null}}return{opaque:t,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:d,sort:h}}function r1(){let i=new WeakMap;function e(n,s){let r=i.get(n),o;return r===void 0?(o=new x0,i.set(n,[o])):s>=r.length?(o=new x0,r.push(o)):o=r[s],o}function t(){i=new WeakMap}return{get:e,dispose:t}}function o1(){let i={};return{get:function(e){if(i[e.id]!==void 0)return i[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={direction:new W,color:new it};break;case"SpotLight":t={position:new W,direction:new W,color:new it,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":t={position:new W,color:new it,distance:0,decay:0};break;case"HemisphereLight":t={direction:new W,skyColor:new it,groundColor:new it};break;case"RectAreaLight":t={color:new it,position:new W,halfWidth:new W,halfHeight:new W};break}return i[e.id]=t,t}}}function a1(){let i={};return{get:function(e){if(i[e.id]!==void 0)return i[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ze};break;case"SpotLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ze};break;case"PointLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new Ze,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[e.id]=t,t}}}var l1=0;function c1(i,e){return(e.castShadow?2:0)-(i.castShadow?2:0)+(e.map?1:0)-(i.map?1:0)}function h1(i){let e=new o1,t=a1(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new W);let s=new W,r=new Mt,o=new Mt;function a(c){let h=0,d=0,u=0;for(let B=0;B<9;B++)n.probe[B].set(0,0,0);let f=0,g=0,y=0,p=0,m=0,x=0,A=0,S=0,R=0,M=0,_=0,E=0,k=0,N=0;c.sort(c1);for(let B=0,V=c.length;B<V;B++){let P=c[B],F=P.color,X=P.intensity,G=P.distance,oe=null;if(P.shadow&&P.shadow.map&&(P.shadow.map.texture.format===dr?oe=P.shadow.map.texture:oe=P.shadow.map.depthTexture||P.shadow.map.texture),P.isAmbientLight)h+=F.r*X,d+=F.g*X,u+=F.b*X;else if(P.isLightProbe){for(let $=0;$<9;$++)n.probe[$].addScaledVector(P.sh.coefficients[$],X);N++}else if(P.isSunLight){let $=e.get(P);if($.color.copy(P.color).multiplyScalar(P.intensity),P.castShadow){let J=P.shadow,ne=t.get(P);ne.shadowIntensity=J.intensity,ne.shadowBias=J.bias,ne.shadowNormalBias=J.normalBias,ne.shadowRadius=J.radius,ne.shadowMapSize.copy(J.mapSize).multiply(J.getFrameExtents()),n.sunShadow[g]=ne,n.sunShadowMap[g]=oe;let ue=J.getViewportCount();for(let ce=0;ce<ue;ce++)n.sunShadowMatrix[y+ce]=J.getMatrix(ce),n.sunShadowCascade[y+ce]=J._cascadeData[ce];y+=ue,g++}n.sun[f]=$,f++}else if(P.isDirectionalLight){let $=e.get(P);if($.color.copy(P.color).multiplyScalar(P.intensity),P.castShadow){let J=P.shadow,ne=t.get(P);ne.shadowIntensity=J.intensity,ne.shadowBias=J.bias,ne.shadowNormalBias=J.normalBias,ne.shadowRadius=J.radius,ne.shadowMapSize=J.mapSize,n.directionalShadow[p]=ne,n.directionalShadowMap[p]=oe,n.directionalShadowMatrix[p]=P.shadow.matrix,R++}n.directional[p]=$,p++}else if(P.isSpotLight){let $=e.get(P);$.position.setFromMatrixPosition(P.matrixWorld),$.color.copy(F).multiplyScalar(X),$.distance=G,$.coneCos=Math.cos(P.angle),$.penumbraCos=Math.cos(P.angle*(1-P.penumbra)),$.decay=P.decay,n.spot[x]=$;let J=P.shadow;if(P.map&&(n.spotLightMap[E]=P.map,E++,J.updateMatrices(P),P.castShadow&&k++),n.spotLightMatrix[x]=J.matrix,P.castShadow){let ne=t.get(P);ne.shadowIntensity=J.intensity,ne.shadowBias=J.bias,ne.shadowNormalBias=J.normalBias,ne.shadowRadius=J.radius,ne.shadowMapSize=J.mapSize,n.spotShadow[x]=ne,n.spotShadowMap[x]=oe,_++}x++}else if(P.isRectAreaLight){let $=e.get(P);$.color.copy(F).multiplyScalar(X),$.halfWidth.set(P.width*.5,0,0),$.halfHeight.set(0,P.height*.5,0),n.rectArea[A]=$,A++}else if(P.isPointLight){let $=e.get(P);if($.color.copy(P.color).multiplyScalar(P.intensity),$.distance=P.distance,$.decay=P.decay,P.castShadow){let J=P.shadow,ne=t.get(P);ne.shadowIntensity=J.intensity,ne.shadowBias=J.bias,ne.shadowNormalBias=J.normalBias,ne.shadowRadius=J.radius,ne.shadowMapSize=J.mapSize,ne.shadowCameraNear=J.camera.near,ne.shadowCameraFar=J.camera.far,n.pointShadow[m]=ne,n.pointShadowMap[m]=oe,n.pointShadowMatrix[m]=P.shadow.matrix,M++}n.point[m]=$,m++}else if(P.isHemisphereLight){let $=e.get(P);$.skyColor.copy(P.color).multiplyScalar(X),$.groundColor.copy(P.groundColor).multiplyScalar(X),n.hemi[S]=$,S++}}A>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=Le.LTC_FLOAT_1,n.rectAreaLTC2=Le.LTC_FLOAT_2):(n.rectAreaLTC1=Le.LTC_HALF_1,n.rectAreaLTC2=Le.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=d,n.ambient[2]=u;let L=n.hash;(L.sunLength!==f||L.directionalLength!==p||L.pointLength!==m||L.spotLength!==x||L.rectAreaLength!==A||L.hemiLength!==S||L.numSunShadows!==g||L.numDirectionalShadows!==R||L.numPointShadows!==M||L.numSpotShadows!==_||L.numSpotMaps!==E||L.numLightProbes!==N)&&(n.sun.length=f,n.directional.length=p,n.spot.length=x,n.rectArea.length=A,n.point.length=m,n.hemi.length=S,n.sunShadow.length=g,n.sunShadowMap.length=g,n.sunShadowMatrix.length=y,n.sunShadowCascade.length=y,n.directionalShadow.length=R,n.directionalShadowMap.length=R,n.directionalShadowMatrix.length=R,n.pointShadow.length=M,n.pointShadowMap.length=M,n.pointShadowMatrix.length=M,n.spotShadow.length=_,n.spotShadowMap.length=_,n.spotLightMatrix.length=_+E-k,n.spotLightMap.length=E,n.numSpotLightShadowsWithMaps=k,n.numLightProbes=N,L.sunLength=f,L.directionalLength=p,L.pointLength=m,L.spotLength=x,L.rectAreaLength=A,L.hemiLength=S,L.numSunShadows=g,L.numDirectionalShadows=R,L.numPointShadows=M,L.numSpotShadows=_,L.numSpotMaps=E,L.numLightProbes=N,n.version=l1++)}function l(c,h){let d=0,u=0,f=0,g=0,y=0,p=0,m=h.matrixWorldInverse;for(let x=0,A=c.length;x<A;x++){let S=c[x];if(S.isSunLight){let R=n.sun[d];R.direction.setFromMatrixPosition(S.matrixWorld),R.direction.transformDirection(m),d++}else if(S.isDirectionalLight){let R=n.directional[u];R.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),R.direction.sub(s),R.direction.transformDirection(m),u++}else if(S.isSpotLight){let R=n.spot[g];R.position.setFromMatrixPosition(S.matrixWorld),R.position.applyMatrix4(m),R.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),R.direction.sub(s),R.direction.transformDirection(m),g++}else if(S.isRectAreaLight){let R=n.rectArea[y];R.position.setFromMatrixPosition(S.matrixWorld),R.position.applyMatrix4(m),o.identity(),r.copy(S.matrixWorld),r.premultiply(m),o.extractRotation(r),R.halfWidth.set(S.width*.5,0,0),R.halfHeight.set(0,S.height*.5,0),R.halfWidth.applyMatrix4(o),R.halfHeight.applyMatrix4(o),y++}else if(S.isPointLight){let R=n.point[f];R.position.setFromMatrixPosition(S.matrixWorld),R.position.applyMatrix4(m),f++}else if(S.isHemisphereLight){let R=n.hemi[p];R.direction.setFromMatrixPosition(S.matrixWorld),R.direction.transformDirection(m),p++}}}return{setup:a,setupView:l,state:n}}function b0(i){let e=new h1(i),t=[],n=[],s=[];function r(d){h.camera=d,t.length=0,n.length=0,s.length=0}function o(d){d.isLightProbeGrid?s.push(d):t.push(d)}function a(d){n.push(d)}function l(){e.setup(t),s.sort((d,u)=>d.priority-u.priority||d.id-u.id)}function c(d){e.setupView(t,d)}let h={lightsArray:t,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:e,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function u1(i){let e=new WeakMap;function t(s,r=0){let o=e.get(s),a;return o===void 0?(a=new b0(i),e.set(s,[a])):r>=o.length?(a=new b0(i),o.push(a)):a=o[r],a}function n(){e=new WeakMap}return{get:t,dispose:n}}var d1=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,f1=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,p1=[new W(1,0,0),new W(-1,0,0),new W(0,1,0),new W(0,-1,0),new W(0,0,1),new W(0,0,-1)],m1=[new W(0,-1,0),new W(0,-1,0),new W(0,0,1),new W(0,0,-1),new W(0,-1,0),new W(0,-1,0)],S0=new Mt,sl=new W,Tf=new W;function g1(i,e,t){let n=new or,s=new Ze,r=new Ze,o=new tn,a=new Vc,l=new Gc,c={},h=t.maxTextureSize,d={[ur]:ai,[ai]:ur,[Kn]:Kn},u=new Fi({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new Ze},radius:{value:4}},vertexShader:d1,fragmentShader:f1}),f=u.clone();f.defines.HORIZONTAL_PASS=1;let g=new nn;g.setAttribute("position",new Ht(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let y=new Zt(g,u),p=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=Lr;let m=this.type;this.render=function(M,_,E){if(p.enabled===!1||p.autoUpdate===!1&&p.needsUpdate===!1||M.length===0)return;this.type===mg&&(Ye("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=Lr);let k=i.getRenderTarget(),N=i.getActiveCubeFace(),L=i.getActiveMipmapLevel(),B=i.state;B.setBlending(Nr),B.buffers.depth.getReversed()===!0?B.buffers.color.setClear(0,0,0,0):B.buffers.color.setClear(1,1,1,1),B.buffers.depth.setTest(!0),B.setScissorTest(!1);let V=m!==this.type;V&&_.traverse(function(P){P.material&&(Array.isArray(P.material)?P.material.forEach(F=>F.needsUpdate=!0):P.material.needsUpdate=!0)});for(let P=0,F=M.length;P<F;P++){let X=M[P],G=X.shadow;if(G===void 0){Ye("WebGLShadowMap:",X,"has no shadow.");continue}if(G.autoUpdate===!1&&G.needsUpdate===!1)continue;s.copy(G.mapSize);let oe=G.getFrameExtents();s.multiply(oe),r.copy(G.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/oe.x),s.x=r.x*oe.x,G.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/oe.y),s.y=r.y*oe.y,G.mapSize.y=r.y));let $=i.state.buffers.depth.getReversed();if(G.camera._reversedDepth=$,G.map===null||V===!0){if(G.map!==null&&(G.map.depthTexture!==null&&(G.map.depthTexture.dispose(),G.map.depthTexture=null),G.map.dispose()),this.type===Oo){if(X.isPointLight){Ye("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}G.map=new Si(s.x,s.y,{format:dr,type:es,minFilter:ri,magFilter:ri,generateMipmaps:!1}),G.map.texture.name=X.name+".shadowMap",G.map.depthTexture=new Us(s.x,s.y,ki),G.map.depthTexture.name=X.name+".shadowMapDepth",G.map.depthTexture.format=Ns,G.map.depthTexture.compareFunction=null,G.map.depthTexture.minFilter=zn,G.map.depthTexture.magFilter=zn}else X.isPointLight?(G.map=new ol(s.x),G.map.depthTexture=new za(s.x,Qi)):(G.map=new Si(s.x,s.y),G.map.depthTexture=new Us(s.x,s.y,Qi)),G.map.depthTexture.name=X.name+".shadowMap",G.map.depthTexture.format=Ns,this.type===Lr?(G.map.depthTexture.compareFunction=$?df:uf,G.map.depthTexture.minFilter=ri,G.map.depthTexture.magFilter=ri):(G.map.depthTexture.compareFunction=null,G.map.depthTexture.minFilter=zn,G.map.depthTexture.magFilter=zn);G.camera.updateProjectionMatrix()}G.map.isWebGLCubeRenderTarget!==!0&&(G.map.width!==s.x||G.map.height!==s.y)&&G.map.setSize(s.x,s.y);let J=G.map.isWebGLCubeRenderTarget?6:G.getViewportCount();X.isPointLight!==!0&&G.updateMatrices(X,E);let ne=(G.camera.layers.mask&4294967294)!==0?G.camera.layers:E.layers;for(let ue=0;ue<J;ue++){let ce=G.getCamera(ue);if(X.isPointLight){let Q=G.camera,pe=G.matrix,me=X.distance||Q.far;me!==Q.far&&(Q.far=me,Q.updateProjectionMatrix()),sl.setFromMatrixPosition(X.matrixWorld),Q.position.copy(sl),Tf.copy(Q.position),Tf.add(p1[ue]),Q.up.copy(m1[ue]),Q.lookAt(Tf),Q.updateMatrixWorld(),pe.makeTranslation(-sl.x,-sl.y,-sl.z),S0.multiplyMatrices(Q.projectionMatrix,Q.matrixWorldInverse),G._frustum.setFromProjectionMatrix(S0,Q.coordinateSystem,Q.reversedDepth)}if(G.map.isWebGLCubeRenderTarget)i.setRenderTarget(G.map,ue),i.clear();else{ue===0&&(i.setRenderTarget(G.map),i.clear());let Q=G.getViewport(ue);o.set(r.x*Q.x,r.y*Q.y,r.x*Q.z,r.y*Q.w),B.viewport(o)}n=G.getFrustum(ue),S(_,E,ce,X,ne,this.type)}G.isPointLightShadow!==!0&&this.type===Oo&&x(G,E),G.needsUpdate=!1}m=this.type,p.needsUpdate=!1,i.setRenderTarget(k,N,L)};function x(M,_){let E=e.update(y);u.defines.VSM_SAMPLES!==M.blurSamples&&(u.defines.VSM_SAMPLES=M.blurSamples,f.defines.VSM_SAMPLES=M.blurSamples,u.needsUpdate=!0,f.needsUpdate=!0),M.mapPass===null?M.mapPass=new Si(s.x,s.y,{format:dr,type:es}):(M.mapPass.width!==M.map.width||M.mapPass.height!==M.map.height)&&M.mapPass.setSize(M.map.width,M.map.height),u.uniforms.shadow_pass.value=M.map.depthTexture,u.uniforms.resolution.value.set(M.map.width,M.map.height),u.uniforms.radius.value=M.radius,i.setRenderTarget(M.mapPass),i.clear(),i.renderBufferDirect(_,null,E,u,y,null),f.uniforms.shadow_pass.value=M.mapPass.texture,f.uniforms.resolution.value.set(M.map.width,M.map.height),f.uniforms.radius.value=M.radius,i.setRenderTarget(M.map),i.clear(),i.renderBufferDirect(_,null,E,f,y,null)}function A(M,_,E,k){let N=null,L=E.isPointLight===!0?M.customDistanceMaterial:M.customDepthMaterial;if(L!==void 0)N=L;else if(N=E.isPointLight===!0?l:a,i.localClippingEnabled&&_.clipShadows===!0&&Array.isArray(_.clippingPlanes)&&_.clippingPlanes.length!==0||_.displacementMap&&_.displacementScale!==0||_.alphaMap&&_.alphaTest>0||_.map&&_.alphaTest>0||_.alphaToCoverage===!0){let B=N.uuid,V=_.uuid,P=c[B];P===void 0&&(P={},c[B]=P);let F=P[V];F===void 0&&(F=N.clone(),P[V]=F,_.addEventListener("dispose",R)),N=F}if(N.visible=_.visible,N.wireframe=_.wireframe,k===Oo?N.side=_.shadowSide!==null?_.shadowSide:_.side:N.side=_.shadowSide!==null?_.shadowSide:d[_.side],N.alphaMap=_.alphaMap,N.alphaTest=_.alphaToCoverage===!0?.5:_.alphaTest,N.map=_.map,N.clipShadows=_.clipShadows,N.clippingPlanes=_.clippingPlanes,N.clipIntersection=_.clipIntersection,N.displacementMap=_.displacementMap,N.displacementScale=_.displacementScale,N.displacementBias=_.displacementBias,N.wireframeLinewidth=_.wireframeLinewidth,N.linewidth=_.linewidth,E.isPointLight===!0&&N.isMeshDistanceMaterial===!0){let B=i.properties.get(N);B.light=E}return N}function S(M,_,E,k,N,L){if(M.visible===!1)return;if(M.layers.test(N)&&(M.isMesh||M.isLine||M.isPoints)&&(M.castShadow||M.receiveShadow&&L===Oo)&&(!M.frustumCulled||M.intersectsFrustum(n))){M.modelViewMatrix.multiplyMatrices(E.matrixWorldInverse,M.matrixWorld);let P=e.update(M),F=M.material;if(Array.isArray(F)){let X=P.groups;for(let G=0,oe=X.length;G<oe;G++){let $=X[G],J=F[$.materialIndex];if(J&&J.visible){let ne=A(M,J,k,L);M.onBeforeShadow(i,M,_,E,P,ne,$),i.renderBufferDirect(E,null,P,ne,M,$),M.onAfterShadow(i,M,_,E,P,ne,$)}}}else if(F.visible){let X=A(M,F,k,L);M.onBeforeShadow(i,M,_,E,P,X,null),i.renderBufferDirect(E,null,P,X,M,null),M.onAfterShadow(i,M,_,E,P,X,null)}}let V=M.children;for(let P=0,F=V.length;P<F;P++)S(V[P],_,E,k,N,L)}function R(M){M.target.removeEventListener("dispose",R);for(let E in c){let k=c[E],N=M.target.uuid;N in k&&(k[N].dispose(),delete k[N])}}}function y1(i,e){function t(){let U=!1,se=new tn,te=null,Te=new tn(0,0,0,0);return{setMask:function(_e){te!==_e&&!U&&(i.colorMask(_e,_e,_e,_e),te=_e)},setLocked:function(_e){U=_e},setClear:function(_e,Me,He,Qe,le){le===!0&&(_e*=Qe,Me*=Qe,He*=Qe),se.set(_e,Me,He,Qe),Te.equals(se)===!1&&(i.clearColor(_e,Me,He,Qe),Te.copy(se))},reset:function(){U=!1,te=null,Te.set(-1,0,0,0)}}}function n(){let U=!1,se=!1,te=null,Te=null,_e=null;return{setReversed:function(Me){if(se!==Me){let He=e.get("EXT_clip_control");Me?He.clipControlEXT(He.LOWER_LEFT_EXT,He.ZERO_TO_ONE_EXT):He.clipControlEXT(He.LOWER_LEFT_EXT,He.NEGATIVE_ONE_TO_ONE_EXT),se=Me;let Qe=_e;_e=null,this.setClear(Qe)}},getReversed:function(){return se},setTest:function(Me){Me?ge(i.DEPTH_TEST):Ve(i.DEPTH_TEST)},setMask:function(Me){te!==Me&&!U&&(i.depthMask(Me),te=Me)},setFunc:function(Me){if(se&&(Me=Zg[Me]),Te!==Me){switch(Me){case wc:i.depthFunc(i.NEVER);break;case Tc:i.depthFunc(i.ALWAYS);break;case Ec:i.depthFunc(i.LESS);break;case Mo:i.depthFunc(i.LEQUAL);break;case Ac:i.depthFunc(i.EQUAL);break;case Rc:i.depthFunc(i.GEQUAL);break;case Cc:i.depthFunc(i.GREATER);break;case Pc:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}Te=Me}},setLocked:function(Me){U=Me},setClear:function(Me){_e!==Me&&(_e=Me,se&&(Me=1-Me),i.clearDepth(Me))},reset:function(){U=!1,te=null,Te=null,_e=null,se=!1}}}function s(){let U=!1,se=null,te=null,Te=null,_e=null,Me=null,He=null,Qe=null,le=null;return{setTest:function(ke){U||(ke?ge(i.STENCIL_TEST):Ve(i.STENCIL_TEST))},setMask:function(ke){se!==ke&&!U&&(i.stencilMask(ke),se=ke)},setFunc:function(ke,et,Re){(te!==ke||Te!==et||_e!==Re)&&(i.stencilFunc(ke,et,Re),te=ke,Te=et,_e=Re)},setOp:function(ke,et,Re){(Me!==ke||He!==et||Qe!==Re)&&(i.stencilOp(ke,et,Re),Me=ke,He=et,Qe=Re)},setLocked:function(ke){U=ke},setClear:function(ke){le!==ke&&(i.clearStencil(ke),le=ke)},reset:function(){U=!1,se=null,te=null,Te=null,_e=null,Me=null,He=null,Qe=null,le=null}}}let r=new t,o=new n,a=new s,l={},c=new WeakMap,h={},d={},u={},f=new WeakMap,g=[],y=null,p=!1,m=null,x=null,A=null,S=null,R=null,M=null,_=null,E=new it(0,0,0),k=0,N=!1,L=null,B=null,V=null,P=null,F=null,X=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),G=!1,oe=0,$=i.getParameter(i.VERSION);$.indexOf("WebGL")!==-1?(oe=parseFloat(/^WebGL (\d)/.exec($)[1]),G=oe>=1):$.indexOf("OpenGL ES")!==-1&&(oe=parseFloat(/^OpenGL ES (\d)/.exec($)[1]),G=oe>=2);let J=null,ne={},ue=i.getParameter(i.SCISSOR_BOX),ce=i.getParameter(i.VIEWPORT),Q=new tn().fromArray(ue),pe=new tn().fromArray(ce);function me(U,se,te,Te){let _e=new Uint8Array(4),Me=i.createTexture();i.bindTexture(U,Me),i.texParameteri(U,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(U,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let He=0;He<te;He++)U===i.TEXTURE_3D||U===i.TEXTURE_2D_ARRAY?i.texImage3D(se,0,i.RGBA,1,1,Te,0,i.RGBA,i.UNSIGNED_BYTE,_e):i.texImage2D(se+He,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,_e);return Me}let ye={};ye[i.TEXTURE_2D]=me(i.TEXTURE_2D,i.TEXTURE_2D,1),ye[i.TEXTURE_CUBE_MAP]=me(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),ye[i.TEXTURE_2D_ARRAY]=me(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),ye[i.TEXTURE_3D]=me(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),ge(i.DEPTH_TEST),o.setFunc(Mo),pn(!1),Dt(Wd),ge(i.CULL_FACE),jt(Nr);function ge(U){h[U]!==!0&&(i.enable(U),h[U]=!0)}function Ve(U){h[U]!==!1&&(i.disable(U),h[U]=!1)}function Je(U,se){return u[U]!==se?(i.bindFramebuffer(U,se),u[U]=se,U===i.DRAW_FRAMEBUFFER&&(u[i.FRAMEBUFFER]=se),U===i.FRAMEBUFFER&&(u[i.DRAW_FRAMEBUFFER]=se),!0):!1}function Ue(U,se){let te=g,Te=!1;if(U){te=f.get(se),te===void 0&&(te=[],f.set(se,te));let _e=U.textures;if(te.length!==_e.length||te[0]!==i.COLOR_ATTACHMENT0){for(let Me=0,He=_e.length;Me<He;Me++)te[Me]=i.COLOR_ATTACHMENT0+Me;te.length=_e.length,Te=!0}}else te[0]!==i.BACK&&(te[0]=i.BACK,Te=!0);Te&&i.drawBuffers(te)}function rt(U){return y!==U?(i.useProgram(U),y=U,!0):!1}let ct={[Dr]:i.FUNC_ADD,[yg]:i.FUNC_SUBTRACT,[_g]:i.FUNC_REVERSE_SUBTRACT};ct[vg]=i.MIN,ct[xg]=i.MAX;let ot={[bg]:i.ZERO,[Sg]:i.ONE,[Mg]:i.SRC_COLOR,[Yd]:i.SRC_ALPHA,[Cg]:i.SRC_ALPHA_SATURATE,[Ag]:i.DST_COLOR,[Tg]:i.DST_ALPHA,[wg]:i.ONE_MINUS_SRC_COLOR,[Zd]:i.ONE_MINUS_SRC_ALPHA,[Rg]:i.ONE_MINUS_DST_COLOR,[Eg]:i.ONE_MINUS_DST_ALPHA,[Pg]:i.CONSTANT_COLOR,[Ig]:i.ONE_MINUS_CONSTANT_COLOR,[Lg]:i.CONSTANT_ALPHA,[Ng]:i.ONE_MINUS_CONSTANT_ALPHA};function jt(U,se,te,Te,_e,Me,He,Qe,le,ke){if(U===Nr){p===!0&&(Ve(i.BLEND),p=!1);return}if(p===!1&&(ge(i.BLEND),p=!0),U!==gg){if(U!==m||ke!==N){if((x!==Dr||R!==Dr)&&(i.blendEquation(i.FUNC_ADD),x=Dr,R=Dr),ke)switch(U){case ko:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Xd:i.blendFunc(i.ONE,i.ONE);break;case qd:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case $d:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:tt("WebGLState: Invalid blending: ",U);break}else switch(U){case ko:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Xd:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case qd:tt("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case $d:tt("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:tt("WebGLState: Invalid blending: ",U);break}A=null,S=null,M=null,_=null,E.set(0,0,0),k=0,m=U,N=ke}return}_e=_e||se,Me=Me||te,He=He||Te,(se!==x||_e!==R)&&(i.blendEquationSeparate(ct[se],ct[_e]),x=se,R=_e),(te!==A||Te!==S||Me!==M||He!==_)&&(i.blendFuncSeparate(ot[te],ot[Te],ot[Me],ot[He]),A=te,S=Te,M=Me,_=He),(Qe.equals(E)===!1||le!==k)&&(i.blendColor(Qe.r,Qe.g,Qe.b,le),E.copy(Qe),k=le),m=U,N=!1}function Gt(U,se){U.side===Kn?Ve(i.CULL_FACE):ge(i.CULL_FACE);let te=U.side===ai;se&&(te=!te),pn(te),U.blending===ko&&U.transparent===!1?jt(Nr):jt(U.blending,U.blendEquation,U.blendSrc,U.blendDst,U.blendEquationAlpha,U.blendSrcAlpha,U.blendDstAlpha,U.blendColor,U.blendAlpha,U.premultipliedAlpha),o.setFunc(U.depthFunc),o.setTest(U.depthTest),o.setMask(U.depthWrite),r.setMask(U.colorWrite);let Te=U.stencilWrite;a.setTest(Te),Te&&(a.setMask(U.stencilWriteMask),a.setFunc(U.stencilFunc,U.stencilRef,U.stencilFuncMask),a.setOp(U.stencilFail,U.stencilZFail,U.stencilZPass)),bt(U.polygonOffset,U.polygonOffsetFactor,U.polygonOffsetUnits),U.alphaToCoverage===!0?ge(i.SAMPLE_ALPHA_TO_COVERAGE):Ve(i.SAMPLE_ALPHA_TO_COVERAGE)}function pn(U){L!==U&&(U?i.frontFace(i.CW):i.frontFace(i.CCW),L=U)}function Dt(U){U!==fg?(ge(i.CULL_FACE),U!==B&&(U===Wd?i.cullFace(i.BACK):U===pg?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):Ve(i.CULL_FACE),B=U}function Dn(U){U!==V&&(G&&i.lineWidth(U),V=U)}function bt(U,se,te){U?(ge(i.POLYGON_OFFSET_FILL),(P!==se||F!==te)&&(P=se,F=te,o.getReversed()&&(se=-se,te=-te),i.polygonOffset(se,te))):Ve(i.POLYGON_OFFSET_FILL)}function Tn(U){U?ge(i.SCISSOR_TEST):Ve(i.SCISSOR_TEST)}function rn(U){U===void 0&&(U=i.TEXTURE0+X-1),J!==U&&(i.activeTexture(U),J=U)}function mn(U,se,te){te===void 0&&(J===null?te=i.TEXTURE0+X-1:te=J);let Te=ne[te];Te===void 0&&(Te={type:void 0,texture:void 0},ne[te]=Te),(Te.type!==U||Te.texture!==se)&&(J!==te&&(i.activeTexture(te),J=te),i.bindTexture(U,se||ye[U]),Te.type=U,Te.texture=se)}function O(){let U=ne[J];U!==void 0&&U.type!==void 0&&(i.bindTexture(U.type,null),U.type=void 0,U.texture=void 0)}function Ce(){try{i.compressedTexImage2D(...arguments)}catch(U){tt("WebGLState:",U)}}function Ke(){try{i.compressedTexImage3D(...arguments)}catch(U){tt("WebGLState:",U)}}function lt(){try{i.texSubImage2D(...arguments)}catch(U){tt("WebGLState:",U)}}function we(){try{i.texSubImage3D(...arguments)}catch(U){tt("WebGLState:",U)}}function Ot(){try{i.compressedTexSubImage2D(...arguments)}catch(U){tt("WebGLState:",U)}}function Ge(){try{i.compressedTexSubImage3D(...arguments)}catch(U){tt("WebGLState:",U)}}function qe(){try{i.texStorage2D(...arguments)}catch(U){tt("WebGLState:",U)}}function C(){try{i.texStorage3D(...arguments)}catch(U){tt("WebGLState:",U)}}function b(){try{i.texImage2D(...arguments)}catch(U){tt("WebGLState:",U)}}function q(){try{i.texImage3D(...arguments)}catch(U){tt("WebGLState:",U)}}function he(U){return d[U]!==void 0?d[U]:i.getParameter(U)}function re(U,se){d[U]!==se&&(i.pixelStorei(U,se),d[U]=se)}function ve(U){Q.equals(U)===!1&&(i.scissor(U.x,U.y,U.z,U.w),Q.copy(U))}function xe(U){pe.equals(U)===!1&&(i.viewport(U.x,U.y,U.z,U.w),pe.copy(U))}function ee(U,se){let te=c.get(se);te===void 0&&(te=new WeakMap,c.set(se,te));let Te=te.get(U);Te===void 0&&(Te=i.getUniformBlockIndex(se,U.name),i.uniformBlockBinding(se,Te,Te),te.set(U,Te))}function ie(U,se,te){let _e=c.get(se).get(U);l[_e]!==te&&(i.bindBufferBase(i.UNIFORM_BUFFER,_e,te),l[_e]=te)}function fe(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),h={},d={},J=null,ne={},u={},l={},f=new WeakMap,g=[],y=null,p=!1,m=null,x=null,A=null,S=null,R=null,M=null,_=null,E=new it(0,0,0),k=0,N=!1,L=null,B=null,V=null,P=null,F=null,Q.set(0,0,i.canvas.width,i.canvas.height),pe.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:ge,disable:Ve,bindFramebuffer:Je,drawBuffers:Ue,useProgram:rt,setBlending:jt,setMaterial:Gt,setFlipSided:pn,setCullFace:Dt,setLineWidth:Dn,setPolygonOffset:bt,setScissorTest:Tn,activeTexture:rn,bindTexture:mn,unbindTexture:O,compressedTexImage2D:Ce,compressedTexImage3D:Ke,texImage2D:b,texImage3D:q,pixelStorei:re,getParameter:he,updateUBOMapping:ee,uniformBlockBinding:ie,texStorage2D:qe,texStorage3D:C,texSubImage2D:lt,texSubImage3D:we,compressedTexSubImage2D:Ot,compressedTexSubImage3D:Ge,scissor:ve,viewport:xe,reset:fe}}function _1(i,e,t,n,s,r,o){let a=e.has("WEBGL_multisampled_render_to_texture")?e.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new Ze,h=new WeakMap,d=new Set,u,f=new WeakMap,g=new Set,y=new FinalizationRegistry(C=>g.delete(C)),p=!1;try{p=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function m(C,b){return p?new OffscreenCanvas(C,b):Ia("canvas")}function x(C,b,q){let he=1,re=qe(C);if((re.width>q||re.height>q)&&(he=q/Math.max(re.width,re.height)),he<1)if(typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&C instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&C instanceof ImageBitmap||typeof VideoFrame<"u"&&C instanceof VideoFrame){let ve=Math.floor(he*re.width),xe=Math.floor(he*re.height);u===void 0&&(u=m(ve,xe));let ee=b?m(ve,xe):u;return ee.width=ve,ee.height=xe,ee.getContext("2d").drawImage(C,0,0,ve,xe),Ye("WebGLRenderer: Texture has been resized from ("+re.width+"x"+re.height+") to ("+ve+"x"+xe+")."),ee}else return"data"in C&&Ye("WebGLRenderer: Image in DataTexture is too big ("+re.width+"x"+re.height+")."),C;return C}function A(C){return C.generateMipmaps}function S(C){i.generateMipmap(C)}function R(C){return C.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:C.isWebGL3DRenderTarget?i.TEXTURE_3D:C.isWebGLArrayRenderTarget||C.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function M(C,b,q,he,re,ve=!1){if(C!==null){if(i[C]!==void 0)return i[C];Ye("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+C+"'")}let xe;he&&(xe=e.get("EXT_texture_norm16"),xe||Ye("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let ee=b;if(b===i.RED&&(q===i.FLOAT&&(ee=i.R32F),q===i.HALF_FLOAT&&(ee=i.R16F),q===i.UNSIGNED_BYTE&&(ee=i.R8),q===i.UNSIGNED_SHORT&&xe&&(ee=xe.R16_EXT),q===i.SHORT&&xe&&(ee=xe.R16_SNORM_EXT)),b===i.RED_INTEGER&&(q===i.UNSIGNED_BYTE&&(ee=i.R8UI),q===i.UNSIGNED_SHORT&&(ee=i.R16UI),q===i.UNSIGNED_INT&&(ee=i.R32UI),q===i.BYTE&&(ee=i.R8I),q===i.SHORT&&(ee=i.R16I),q===i.INT&&(ee=i.R32I)),b===i.RG&&(q===i.FLOAT&&(ee=i.RG32F),q===i.HALF_FLOAT&&(ee=i.RG16F),q===i.UNSIGNED_BYTE&&(ee=i.RG8),q===i.UNSIGNED_SHORT&&xe&&(ee=xe.RG16_EXT),q===i.SHORT&&xe&&(ee=xe.RG16_SNORM_EXT)),b===i.RG_INTEGER&&(q===i.UNSIGNED_BYTE&&(ee=i.RG8UI),q===i.UNSIGNED_SHORT&&(ee=i.RG16UI),q===i.UNSIGNED_INT&&(ee=i.RG32UI),q===i.BYTE&&(ee=i.RG8I),q===i.SHORT&&(ee=i.RG16I),q===i.INT&&(ee=i.RG32I)),b===i.RGB_INTEGER&&(q===i.UNSIGNED_BYTE&&(ee=i.RGB8UI),q===i.UNSIGNED_SHORT&&(ee=i.RGB16UI),q===i.UNSIGNED_INT&&(ee=i.RGB32UI),q===i.BYTE&&(ee=i.RGB8I),q===i.SHORT&&(ee=i.RGB16I),q===i.INT&&(ee=i.RGB32I)),b===i.RGBA_INTEGER&&(q===i.UNSIGNED_BYTE&&(ee=i.RGBA8UI),q===i.UNSIGNED_SHORT&&(ee=i.RGBA16UI),q===i.UNSIGNED_INT&&(ee=i.RGBA32UI),q===i.BYTE&&(ee=i.RGBA8I),q===i.SHORT&&(ee=i.RGBA16I),q===i.INT&&(ee=i.RGBA32I)),b===i.RGB&&(q===i.UNSIGNED_SHORT&&xe&&(ee=xe.RGB16_EXT),q===i.SHORT&&xe&&(ee=xe.RGB16_SNORM_EXT),q===i.UNSIGNED_INT_5_9_9_9_REV&&(ee=i.RGB9_E5),q===i.UNSIGNED_INT_10F_11F_11F_REV&&(ee=i.R11F_G11F_B10F)),b===i.RGBA){let ie=ve?Pa:vt.getTransfer(re);q===i.FLOAT&&(ee=i.RGBA32F),q===i.HALF_FLOAT&&(ee=i.RGBA16F),q===i.UNSIGNED_BYTE&&(ee=ie===Ct?i.SRGB8_ALPHA8:i.RGBA8),q===i.UNSIGNED_SHORT&&xe&&(ee=xe.RGBA16_EXT),q===i.SHORT&&xe&&(ee=xe.RGBA16_SNORM_EXT),q===i.UNSIGNED_SHORT_4_4_4_4&&(ee=i.RGBA4),q===i.UNSIGNED_SHORT_5_5_5_1&&(ee=i.RGB5_A1)}return(ee===i.R16F||ee===i.R32F||ee===i.RG16F||ee===i.RG32F||ee===i.RGBA16F||ee===i.RGBA32F)&&e.get("EXT_color_buffer_float"),ee}function _(C,b){let q;return C?b===null||b===Qi||b===Ur?q=i.DEPTH24_STENCIL8:b===ki?q=i.DEPTH32F_STENCIL8:b===zo&&(q=i.DEPTH24_STENCIL8,Ye("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):b===null||b===Qi||b===Ur?q=i.DEPTH_COMPONENT24:b===ki?q=i.DEPTH_COMPONENT32F:b===zo&&(q=i.DEPTH_COMPONENT16),q}function E(C,b){return A(C)===!0||C.isFramebufferTexture&&C.minFilter!==zn&&C.minFilter!==ri?Math.log2(Math.max(b.width,b.height))+1:C.mipmaps.length>0?C.mipmaps.length:C.isCompressedTexture&&Array.isArray(C.image)?b.mipmaps.length:1}function k(C){let b=new WeakRef(C);n.get(C).__ref=b,g.add(b),y.register(C,b,b)}function N(C){let b=n.get(C).__ref;b!==void 0&&(g.delete(b),y.unregister(b))}function L(C){V(C.target)}function B(C){P(C.target)}function V(C){C.removeEventListener("dispose",L),N(C),X(C),C.isVideoTexture&&h.delete(C),C.isHTMLTexture&&d.delete(C)}function P(C){C.removeEventListener("dispose",B),N(C),oe(C)}function F(){for(let C of g){let b=C.deref();b!==void 0&&(b.isRenderTarget===!0?P(b):V(b))}g.clear(),d.clear()}function X(C){let b=n.get(C);if(b.__webglInit===void 0)return;let q=C.source,he=f.get(q);if(he){let re=he[b.__cacheKey];re.usedTimes--,re.usedTimes===0&&G(C),Object.keys(he).length===0&&f.delete(q)}n.remove(C)}function G(C){let b=n.get(C);i.deleteTexture(b.__webglTexture);let q=C.source,he=f.get(q);delete he[b.__cacheKey],o.memory.textures--}function oe(C){let b=n.get(C);b.__depthDisposeCallback&&b.__depthDisposeCallback();let q=C.depthTexture;if(q&&q.renderTarget===C&&V(q),C.isWebGLCubeRenderTarget)for(let re=0;re<6;re++){if(Array.isArray(b.__webglFramebuffer[re]))for(let ve=0;ve<b.__webglFramebuffer[re].length;ve++)i.deleteFramebuffer(b.__webglFramebuffer[re][ve]);else i.deleteFramebuffer(b.__webglFramebuffer[re]);b.__webglDepthbuffer&&i.deleteRenderbuffer(b.__webglDepthbuffer[re])}else{if(Array.isArray(b.__webglFramebuffer))for(let re=0;re<b.__webglFramebuffer.length;re++)i.deleteFramebuffer(b.__webglFramebuffer[re]);else i.deleteFramebuffer(b.__webglFramebuffer);if(b.__webglDepthbuffer&&i.deleteRenderbuffer(b.__webglDepthbuffer),b.__webglMultisampledFramebuffer&&i.deleteFramebuffer(b.__webglMultisampledFramebuffer),b.__webglColorRenderbuffer)for(let re=0;re<b.__webglColorRenderbuffer.length;re++)b.__webglColorRenderbuffer[re]&&i.deleteRenderbuffer(b.__webglColorRenderbuffer[re]);b.__webglDepthRenderbuffer&&i.deleteRenderbuffer(b.__webglDepthRenderbuffer)}let he=C.textures;for(let re=0,ve=he.length;re<ve;re++){let xe=n.get(he[re]);xe.__webglTexture&&(i.deleteTexture(xe.__webglTexture),o.memory.textures--),n.remove(he[re])}n.remove(C)}let $=0;function J(){$=0}function ne(){return $}function ue(C){$=C}function ce(){let C=$;return C>=s.maxTextures&&Ye("WebGLTextures: Trying to use "+(C+1)+" texture units while this GPU supports only "+s.maxTextures),$+=1,C}function Q(C){let b=[];return b.push(C.wrapS),b.push(C.wrapT),b.push(C.wrapR||0),b.push(C.magFilter),b.push(C.minFilter),b.push(C.anisotropy),b.push(C.internalFormat),b.push(C.format),b.push(C.type),b.push(C.generateMipmaps),b.push(C.mipmapsAutoUpdate),b.push(C.premultiplyAlpha),b.push(C.flipY),b.push(C.unpackAlignment),b.push(C.colorSpace),b.join()}function pe(C,b){let q=n.get(C);if(C.isVideoTexture&&Ot(C),C.isRenderTargetTexture===!1&&C.isExternalTexture!==!0&&C.version>0&&q.__version!==C.version){let he=C.image;if(he===null)Ye("WebGLRenderer: Texture marked for update but no image data found.");else if(he.complete===!1)Ye("WebGLRenderer: Texture marked for update but image is incomplete");else{Gt(q,C,b);return}}else C.isExternalTexture&&(q.__webglTexture=C.sourceTexture?C.sourceTexture:null);t.bindTexture(i.TEXTURE_2D,q.__webglTexture,i.TEXTURE0+b)}function me(C,b){let q=n.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&q.__version!==C.version){Gt(q,C,b);return}else C.isExternalTexture&&(q.__webglTexture=C.sourceTexture?C.sourceTexture:null);t.bindTexture(i.TEXTURE_2D_ARRAY,q.__webglTexture,i.TEXTURE0+b)}function ye(C,b){let q=n.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&q.__version!==C.version){Gt(q,C,b);return}t.bindTexture(i.TEXTURE_3D,q.__webglTexture,i.TEXTURE0+b)}function ge(C,b){let q=n.get(C);if(C.version>0&&q.__version!==C.version){pn(q,C,b);return}t.bindTexture(i.TEXTURE_CUBE_MAP,q.__webglTexture,i.TEXTURE0+b)}let Ve={[Ic]:i.REPEAT,[ms]:i.CLAMP_TO_EDGE,[Lc]:i.MIRRORED_REPEAT},Je={[zn]:i.NEAREST,[Ug]:i.NEAREST_MIPMAP_NEAREST,[Ja]:i.NEAREST_MIPMAP_LINEAR,[ri]:i.LINEAR,[sh]:i.LINEAR_MIPMAP_NEAREST,[ks]:i.LINEAR_MIPMAP_LINEAR},Ue={[zg]:i.NEVER,[ff]:i.ALWAYS,[Vg]:i.LESS,[uf]:i.LEQUAL,[Gg]:i.EQUAL,[df]:i.GEQUAL,[Hg]:i.GREATER,[Wg]:i.NOTEQUAL};function rt(C,b){if(b.type===ki&&e.has("OES_texture_float_linear")===!1&&(b.magFilter===ri||b.magFilter===sh||b.magFilter===Ja||b.magFilter===ks||b.minFilter===ri||b.minFilter===sh||b.minFilter===Ja||b.minFilter===ks)&&Ye("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(C,i.TEXTURE_WRAP_S,Ve[b.wrapS]),i.texParameteri(C,i.TEXTURE_WRAP_T,Ve[b.wrapT]),(C===i.TEXTURE_3D||C===i.TEXTURE_2D_ARRAY)&&i.texParameteri(C,i.TEXTURE_WRAP_R,Ve[b.wrapR]),i.texParameteri(C,i.TEXTURE_MAG_FILTER,Je[b.magFilter]),i.texParameteri(C,i.TEXTURE_MIN_FILTER,Je[b.minFilter]),b.compareFunction&&(i.texParameteri(C,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(C,i.TEXTURE_COMPARE_FUNC,Ue[b.compareFunction])),e.has("EXT_texture_filter_anisotropic")===!0){if(b.magFilter===zn||b.minFilter!==Ja&&b.minFilter!==ks||b.type===ki&&e.has("OES_texture_float_linear")===!1)return;if(b.anisotropy>1||n.get(b).__currentAnisotropy){let q=e.get("EXT_texture_filter_anisotropic");i.texParameterf(C,q.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(b.anisotropy,s.getMaxAnisotropy())),n.get(b).__currentAnisotropy=b.anisotropy}}}function ct(C,b){let q=!1;C.__webglInit===void 0&&(C.__webglInit=!0,b.addEventListener("dispose",L),k(b));let he=b.source,re=f.get(he);re===void 0&&(re={},f.set(he,re));let ve=Q(b);if(ve!==C.__cacheKey){re[ve]===void 0&&(re[ve]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,q=!0),re[ve].usedTimes++;let xe=re[C.__cacheKey];xe!==void 0&&(re[C.__cacheKey].usedTimes--,xe.usedTimes===0&&G(b)),C.__cacheKey=ve,C.__webglTexture=re[ve].texture}return q}function ot(C,b,q){return Math.floor(Math.floor(C/q)/b)}function jt(C,b,q,he){let ve=C.updateRanges;if(ve.length===0)t.texSubImage2D(i.TEXTURE_2D,0,0,0,b.width,b.height,q,he,b.data);else{ve.sort((U,se)=>U.start-se.start);let xe=0;for(let U=1;U<ve.length;U++){let se=ve[xe],te=ve[U],Te=se.start+se.count,_e=ot(te.start,b.width,4),Me=ot(se.start,b.width,4);te.start<=Te+1&&_e===Me&&ot(te.start+te.count-1,b.width,4)===_e?se.count=Math.max(se.count,te.start+te.count-se.start):(++xe,ve[xe]=te)}ve.length=xe+1;let ee=t.getParameter(i.UNPACK_ROW_LENGTH),ie=t.getParameter(i.UNPACK_SKIP_PIXELS),fe=t.getParameter(i.UNPACK_SKIP_ROWS);t.pixelStorei(i.UNPACK_ROW_LENGTH,b.width);for(let U=0,se=ve.length;U<se;U++){let te=ve[U],Te=Math.floor(te.start/4),_e=Math.ceil(te.count/4),Me=Te%b.width,He=Math.floor(Te/b.width),Qe=_e,le=1;t.pixelStorei(i.UNPACK_SKIP_PIXELS,Me),t.pixelStorei(i.UNPACK_SKIP_ROWS,He),t.texSubImage2D(i.TEXTURE_2D,0,Me,He,Qe,le,q,he,b.data)}C.clearUpdateRanges(),t.pixelStorei(i.UNPACK_ROW_LENGTH,ee),t.pixelStorei(i.UNPACK_SKIP_PIXELS,ie),t.pixelStorei(i.UNPACK_SKIP_ROWS,fe)}}function Gt(C,b,q){let he=i.TEXTURE_2D;(b.isDataArrayTexture||b.isCompressedArrayTexture)&&(he=i.TEXTURE_2D_ARRAY),b.isData3DTexture&&(he=i.TEXTURE_3D);let re=ct(C,b),ve=b.source;t.bindTexture(he,C.__webglTexture,i.TEXTURE0+q);let xe=n.get(ve);if(ve.version!==xe.__version||re===!0){if(t.activeTexture(i.TEXTURE0+q),(typeof ImageBitmap<"u"&&b.image instanceof ImageBitmap)===!1){let le=vt.getPrimaries(vt.workingColorSpace),ke=b.colorSpace===zs?null:vt.getPrimaries(b.colorSpace),et=b.colorSpace===zs||le===ke?i.NONE:i.BROWSER_DEFAULT_WEBGL;t.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,b.flipY),t.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),t.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,et)}t.pixelStorei(i.UNPACK_ALIGNMENT,b.unpackAlignment);let ie=x(b.image,!1,s.maxTextureSize);ie=Ge(b,ie);let fe=r.convert(b.format,b.colorSpace),U=r.convert(b.type),se=M(b.internalFormat,fe,U,b.normalized,b.colorSpace,b.isVideoTexture);rt(he,b);let te,Te=b.mipmaps,_e=b.isVideoTexture!==!0,Me=xe.__version===void 0||re===!0,He=ve.dataReady,Qe=E(b,ie);if(b.isDepthTexture)se=_(b.format===Bs,b.type),Me&&(_e?t.texStorage2D(i.TEXTURE_2D,1,se,ie.width,ie.height):t.texImage2D(i.TEXTURE_2D,0,se,ie.width,ie.height,0,fe,U,null));else if(b.isDataTexture)if(Te.length>0){_e&&Me&&t.texStorage2D(i.TEXTURE_2D,Qe,se,Te[0].width,Te[0].height);for(let le=0,ke=Te.length;le<ke;le++)te=Te[le],_e?He&&t.texSubImage2D(i.TEXTURE_2D,le,0,0,te.width,te.height,fe,U,te.data):t.texImage2D(i.TEXTURE_2D,le,se,te.width,te.height,0,fe,U,te.data);b.generateMipmaps=!1}else _e?(Me&&t.texStorage2D(i.TEXTURE_2D,Qe,se,ie.width,ie.height),He&&jt(b,ie,fe,U)):t.texImage2D(i.TEXTURE_2D,0,se,ie.width,ie.height,0,fe,U,ie.data);else if(b.isCompressedTexture)if(b.isCompressedArrayTexture){_e&&Me&&t.texStorage3D(i.TEXTURE_2D_ARRAY,Qe,se,Te[0].width,Te[0].height,ie.depth);for(let le=0,ke=Te.length;le<ke;le++)if(te=Te[le],b.format!==ts)if(fe!==null)if(_e){if(He)if(b.layerUpdates.size>0){let et=Mf(te.width,te.height,b.format,b.type);for(let Re of b.layerUpdates){let ht=te.data.subarray(Re*et/te.data.BYTES_PER_ELEMENT,(Re+1)*et/te.data.BYTES_PER_ELEMENT);t.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,le,0,0,Re,te.width,te.height,1,fe,ht)}}else t.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,le,0,0,0,te.width,te.height,ie.depth,fe,te.data)}else t.compressedTexImage3D(i.TEXTURE_2D_ARRAY,le,se,te.width,te.height,ie.depth,0,te.data,0,0);else Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else _e?He&&t.texSubImage3D(i.TEXTURE_2D_ARRAY,le,0,0,0,te.width,te.height,ie.depth,fe,U,te.data):t.texImage3D(i.TEXTURE_2D_ARRAY,le,se,te.width,te.height,ie.depth,0,fe,U,te.data);b.layerUpdates.size>0&&b.clearLayerUpdates()}else{_e&&Me&&t.texStorage2D(i.TEXTURE_2D,Qe,se,Te[0].width,Te[0].height);for(let le=0,ke=Te.length;le<ke;le++)te=Te[le],b.format!==ts?fe!==null?_e?He&&t.compressedTexSubImage2D(i.TEXTURE_2D,le,0,0,te.width,te.height,fe,te.data):t.compressedTexImage2D(i.TEXTURE_2D,le,se,te.width,te.height,0,te.data):Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):_e?He&&t.texSubImage2D(i.TEXTURE_2D,le,0,0,te.width,te.height,fe,U,te.data):t.texImage2D(i.TEXTURE_2D,le,se,te.width,te.height,0,fe,U,te.data)}else if(b.isDataArrayTexture)if(_e){if(Me&&t.texStorage3D(i.TEXTURE_2D_ARRAY,Qe,se,ie.width,ie.height,ie.depth),He)if(b.layerUpdates.size>0){let le=Mf(ie.width,ie.height,b.format,b.type);for(let ke of b.layerUpdates){let et=ie.data.subarray(ke*le/ie.data.BYTES_PER_ELEMENT,(ke+1)*le/ie.data.BYTES_PER_ELEMENT);t.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,ke,ie.width,ie.height,1,fe,U,et)}b.clearLayerUpdates()}else t.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,ie.width,ie.height,ie.depth,fe,U,ie.data)}else t.texImage3D(i.TEXTURE_2D_ARRAY,0,se,ie.width,ie.height,ie.depth,0,fe,U,ie.data);else if(b.isData3DTexture)_e?(Me&&t.texStorage3D(i.TEXTURE_3D,Qe,se,ie.width,ie.height,ie.depth),He&&t.texSubImage3D(i.TEXTURE_3D,0,0,0,0,ie.width,ie.height,ie.depth,fe,U,ie.data)):t.texImage3D(i.TEXTURE_3D,0,se,ie.width,ie.height,ie.depth,0,fe,U,ie.data);else if(b.isFramebufferTexture){if(Me)if(_e)t.texStorage2D(i.TEXTURE_2D,Qe,se,ie.width,ie.height);else{let le=ie.width,ke=ie.height;for(let et=0;et<Qe;et++)t.texImage2D(i.TEXTURE_2D,et,se,le,ke,0,fe,U,null),le>>=1,ke>>=1}}else if(b.isHTMLTexture){if("texElementImage2D"in i){let le=i.canvas;if(le.hasAttribute("layoutsubtree")||le.setAttribute("layoutsubtree","true"),ie.parentNode!==le){le.appendChild(ie),d.add(b),le.onpaint=ke=>{let et=ke.changedElements;for(let Re of d)et.includes(Re.image)&&(Re.needsUpdate=!0)},le.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,ie);else{let et=i.RGBA,Re=i.RGBA,ht=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,et,Re,ht,ie)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(Te.length>0){if(_e&&Me){let le=qe(Te[0]);t.texStorage2D(i.TEXTURE_2D,Qe,se,le.width,le.height)}for(let le=0,ke=Te.length;le<ke;le++)te=Te[le],_e?He&&t.texSubImage2D(i.TEXTURE_2D,le,0,0,fe,U,te):t.texImage2D(i.TEXTURE_2D,le,se,fe,U,te);b.generateMipmaps=!1}else if(_e){if(Me){let le=qe(ie);t.texStorage2D(i.TEXTURE_2D,Qe,se,le.width,le.height)}He&&t.texSubImage2D(i.TEXTURE_2D,0,0,0,fe,U,ie)}else t.texImage2D(i.TEXTURE_2D,0,se,fe,U,ie);A(b)&&b.mipmapsAutoUpdate===!0&&S(he),xe.__version=ve.version,b.onUpdate&&b.onUpdate(b)}C.__version=b.version}function pn(C,b,q){if(b.image.length!==6)return;let he=ct(C,b),re=b.source;t.bindTexture(i.TEXTURE_CUBE_MAP,C.__webglTexture,i.TEXTURE0+q);let ve=n.get(re);if(re.version!==ve.__version||he===!0){t.activeTexture(i.TEXTURE0+q);let xe=vt.getPrimaries(vt.workingColorSpace),ee=b.colorSpace===zs?null:vt.getPrimaries(b.colorSpace),ie=b.colorSpace===zs||xe===ee?i.NONE:i.BROWSER_DEFAULT_WEBGL;t.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,b.flipY),t.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,b.premultiplyAlpha),t.pixelStorei(i.UNPACK_ALIGNMENT,b.unpackAlignment),t.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,ie);let fe=b.isCompressedTexture||b.image[0].isCompressedTexture,U=b.image[0]&&b.image[0].isDataTexture,se=[];for(let Re=0;Re<6;Re++)!fe&&!U?se[Re]=x(b.image[Re],!0,s.maxCubemapSize):se[Re]=U?b.image[Re].image:b.image[Re],se[Re]=Ge(b,se[Re]);let te=se[0],Te=r.convert(b.format,b.colorSpace),_e=r.convert(b.type),Me=M(b.internalFormat,Te,_e,b.normalized,b.colorSpace),He=b.isVideoTexture!==!0,Qe=ve.__version===void 0||he===!0,le=re.dataReady,ke=E(b,te);rt(i.TEXTURE_CUBE_MAP,b);let et;if(b.isDepthTexture){if(Me=_(b.format===Bs,b.type),Qe)if(He)t.texStorage2D(i.TEXTURE_CUBE_MAP,1,Me,te.width,te.height);else for(let Re=0;Re<6;Re++)t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,0,Me,te.width,te.height,0,Te,_e,null)}else if(fe){He&&Qe&&t.texStorage2D(i.TEXTURE_CUBE_MAP,ke,Me,te.width,te.height);for(let Re=0;Re<6;Re++){et=se[Re].mipmaps;for(let ht=0;ht<et.length;ht++){let Wt=et[ht];b.format!==ts?Te!==null?He?le&&t.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht,0,0,Wt.width,Wt.height,Te,Wt.data):t.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht,Me,Wt.width,Wt.height,0,Wt.data):Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):He?le&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht,0,0,Wt.width,Wt.height,Te,_e,Wt.data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht,Me,Wt.width,Wt.height,0,Te,_e,Wt.data)}}}else{if(et=b.mipmaps,He&&Qe){et.length>0&&ke++;let Re=qe(se[0]);t.texStorage2D(i.TEXTURE_CUBE_MAP,ke,Me,Re.width,Re.height)}for(let Re=0;Re<6;Re++)if(U){He?le&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,0,0,0,se[Re].width,se[Re].height,Te,_e,se[Re].data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,0,Me,se[Re].width,se[Re].height,0,Te,_e,se[Re].data);for(let ht=0;ht<et.length;ht++){let jn=et[ht].image[Re].image;He?le&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht+1,0,0,jn.width,jn.height,Te,_e,jn.data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht+1,Me,jn.width,jn.height,0,Te,_e,jn.data)}}else{He?le&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,0,0,0,Te,_e,se[Re]):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,0,Me,Te,_e,se[Re]);for(let ht=0;ht<et.length;ht++){let Wt=et[ht];He?le&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht+1,0,0,Te,_e,Wt.image[Re]):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Re,ht+1,Me,Te,_e,Wt.image[Re])}}}A(b)&&b.mipmapsAutoUpdate===!0&&S(i.TEXTURE_CUBE_MAP),ve.__version=re.version,b.onUpdate&&b.onUpdate(b)}C.__version=b.version}function Dt(C,b,q,he,re,ve){let xe=r.convert(q.format,q.colorSpace),ee=r.convert(q.type),ie=M(q.internalFormat,xe,ee,q.normalized,q.colorSpace),fe=n.get(b),U=n.get(q);if(U.__renderTarget=b,!fe.__hasExternalTextures){let se=Math.max(1,b.width>>ve),te=Math.max(1,b.height>>ve);re===i.TEXTURE_3D||re===i.TEXTURE_2D_ARRAY?t.texImage3D(re,ve,ie,se,te,b.depth,0,xe,ee,null):t.texImage2D(re,ve,ie,se,te,0,xe,ee,null)}t.bindFramebuffer(i.FRAMEBUFFER,C),we(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,he,re,U.__webglTexture,0,lt(b)):(re===i.TEXTURE_2D||re>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&re<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,he,re,U.__webglTexture,ve),t.bindFramebuffer(i.FRAMEBUFFER,null)}function Dn(C,b,q){if(i.bindRenderbuffer(i.RENDERBUFFER,C),b.depthBuffer){let he=b.depthTexture,re=he&&he.isDepthTexture?he.type:null,ve=_(b.stencilBuffer,re),xe=b.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;we(b)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,lt(b),ve,b.width,b.height):q?i.renderbufferStorageMultisample(i.RENDERBUFFER,lt(b),ve,b.width,b.height):i.renderbufferStorage(i.RENDERBUFFER,ve,b.width,b.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,xe,i.RENDERBUFFER,C)}else{let he=b.textures;for(let re=0;re<he.length;re++){let ve=he[re],xe=r.convert(ve.format,ve.colorSpace),ee=r.convert(ve.type),ie=M(ve.internalFormat,xe,ee,ve.normalized,ve.colorSpace);we(b)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,lt(b),ie,b.width,b.height):q?i.renderbufferStorageMultisample(i.RENDERBUFFER,lt(b),ie,b.width,b.height):i.renderbufferStorage(i.RENDERBUFFER,ie,b.width,b.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function bt(C,b,q){let he=b.isWebGLCubeRenderTarget===!0;if(t.bindFramebuffer(i.FRAMEBUFFER,C),!(b.depthTexture&&b.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let re=n.get(b.depthTexture);re.__renderTarget=b;let ve=he?b.depthTexture.image[0]:b.depthTexture.image;(!re.__webglTexture||ve.width!==b.width||ve.height!==b.height)&&(ve.width=b.width,ve.height=b.height,b.depthTexture.needsUpdate=!0),he?ge(b.depthTexture,0):pe(b.depthTexture,0);let xe=re.__webglTexture,ee=lt(b),ie=he?i.TEXTURE_CUBE_MAP_POSITIVE_X+q:i.TEXTURE_2D,fe=b.depthTexture.format===Bs?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(b.depthTexture.format===Ns)we(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,fe,ie,xe,0,ee):i.framebufferTexture2D(i.FRAMEBUFFER,fe,ie,xe,0);else if(b.depthTexture.format===Bs)we(b)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,fe,ie,xe,0,ee):i.framebufferTexture2D(i.FRAMEBUFFER,fe,ie,xe,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function Tn(C){let b=n.get(C),q=C.isWebGLCubeRenderTarget===!0;if(b.__boundDepthTexture!==C.depthTexture){let he=C.depthTexture;if(b.__depthDisposeCallback&&b.__depthDisposeCallback(),he){let re=()=>{delete b.__boundDepthTexture,delete b.__depthDisposeCallback,he.removeEventListener("dispose",re)};he.addEventListener("dispose",re),b.__depthDisposeCallback=re}b.__boundDepthTexture=he}if(C.depthTexture&&!b.__autoAllocateDepthBuffer)if(q)for(let he=0;he<6;he++)bt(b.__webglFramebuffer[he],C,he);else C.texture.mipmaps.length>0?bt(b.__webglFramebuffer[0],C,0):bt(b.__webglFramebuffer,C,0);else if(q){b.__webglDepthbuffer=[];for(let he=0;he<6;he++)if(t.bindFramebuffer(i.FRAMEBUFFER,b.__webglFramebuffer[he]),b.__webglDepthbuffer[he]===void 0)b.__webglDepthbuffer[he]=i.createRenderbuffer(),Dn(b.__webglDepthbuffer[he],C,!1);else{let re=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ve=b.__webglDepthbuffer[he];i.bindRenderbuffer(i.RENDERBUFFER,ve),i.framebufferRenderbuffer(i.FRAMEBUFFER,re,i.RENDERBUFFER,ve)}}else if(C.texture.mipmaps.length>0?t.bindFramebuffer(i.FRAMEBUFFER,b.__webglFramebuffer[0]):t.bindFramebuffer(i.FRAMEBUFFER,b.__webglFramebuffer),b.__webglDepthbuffer===void 0)b.__webglDepthbuffer=i.createRenderbuffer(),Dn(b.__webglDepthbuffer,C,!1);else{let re=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ve=b.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,ve),i.framebufferRenderbuffer(i.FRAMEBUFFER,re,i.RENDERBUFFER,ve)}t.bindFramebuffer(i.FRAMEBUFFER,null)}function rn(C,b,q){let he=n.get(C);b!==void 0&&Dt(he.__webglFramebuffer,C,C.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),q!==void 0&&Tn(C)}function mn(C){let b=C.texture,q=n.get(C),he=n.get(b);C.addEventListener("dispose",B),k(C);let re=C.textures,ve=C.isWebGLCubeRenderTarget===!0,xe=re.length>1;if(xe||(he.__webglTexture===void 0&&(he.__webglTexture=i.createTexture()),he.__version=b.version,o.memory.textures++),ve){q.__webglFramebuffer=[];for(let ee=0;ee<6;ee++)if(b.mipmaps.length>0){q.__webglFramebuffer[ee]=[];for(let ie=0;ie<b.mipmaps.length;ie++)q.__webglFramebuffer[ee][ie]=i.createFramebuffer()}else q.__webglFramebuffer[ee]=i.createFramebuffer()}else{if(b.mipmaps.length>0){q.__webglFramebuffer=[];for(let ee=0;ee<b.mipmaps.length;ee++)q.__webglFramebuffer[ee]=i.createFramebuffer()}else q.__webglFramebuffer=i.createFramebuffer();if(xe)for(let ee=0,ie=re.length;ee<ie;ee++){let fe=n.get(re[ee]);fe.__webglTexture===void 0&&(fe.__webglTexture=i.createTexture(),o.memory.textures++)}if(C.samples>0&&we(C)===!1){q.__webglMultisampledFramebuffer=i.createFramebuffer(),q.__webglColorRenderbuffer=[],t.bindFramebuffer(i.FRAMEBUFFER,q.__webglMultisampledFramebuffer);for(let ee=0;ee<re.length;ee++){let ie=re[ee];q.__webglColorRenderbuffer[ee]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,q.__webglColorRenderbuffer[ee]);let fe=r.convert(ie.format,ie.colorSpace),U=r.convert(ie.type),se=M(ie.internalFormat,fe,U,ie.normalized,ie.colorSpace,C.isXRRenderTarget===!0),te=lt(C);i.renderbufferStorageMultisample(i.RENDERBUFFER,te,se,C.width,C.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+ee,i.RENDERBUFFER,q.__webglColorRenderbuffer[ee])}i.bindRenderbuffer(i.RENDERBUFFER,null),C.depthBuffer&&(q.__webglDepthRenderbuffer=i.createRenderbuffer(),Dn(q.__webglDepthRenderbuffer,C,!0)),t.bindFramebuffer(i.FRAMEBUFFER,null)}}if(ve){t.bindTexture(i.TEXTURE_CUBE_MAP,he.__webglTexture),rt(i.TEXTURE_CUBE_MAP,b);for(let ee=0;ee<6;ee++)if(b.mipmaps.length>0)for(let ie=0;ie<b.mipmaps.length;ie++)Dt(q.__webglFramebuffer[ee][ie],C,b,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+ee,ie);else Dt(q.__webglFramebuffer[ee],C,b,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+ee,0);A(b)?S(i.TEXTURE_CUBE_MAP):b.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,b.mipmaps.length-1),t.unbindTexture()}else if(xe){for(let ee=0,ie=re.length;ee<ie;ee++){let fe=re[ee],U=n.get(fe),se=i.TEXTURE_2D;(C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(se=C.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),t.bindTexture(se,U.__webglTexture),rt(se,fe),Dt(q.__webglFramebuffer,C,fe,i.COLOR_ATTACHMENT0+ee,se,0),A(fe)&&S(se)}t.unbindTexture()}else{let ee=i.TEXTURE_2D;if((C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(ee=C.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),t.bindTexture(ee,he.__webglTexture),rt(ee,b),b.mipmaps.length>0)for(let ie=0;ie<b.mipmaps.length;ie++)Dt(q.__webglFramebuffer[ie],C,b,i.COLOR_ATTACHMENT0,ee,ie);else Dt(q.__webglFramebuffer,C,b,i.COLOR_ATTACHMENT0,ee,0);A(b)?S(ee):b.mipmaps.length>0&&i.texParameteri(ee,i.TEXTURE_MAX_LEVEL,b.mipmaps.length-1),t.unbindTexture()}C.depthBuffer&&Tn(C)}function O(C){let b=C.textures;for(let q=0,he=b.length;q<he;q++){let re=b[q];if(A(re)&&re.mipmapsAutoUpdate===!0){let ve=R(C),xe=n.get(re).__webglTexture;t.bindTexture(ve,xe),S(ve),t.unbindTexture()}}}let Ce=[];function Ke(C){if(C.samples>0){if(we(C)===!1){let b=C.textures,q=C.width,he=C.height,re=i.COLOR_BUFFER_BIT,ve=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,xe=n.get(C),ee=b.length>1;if(ee)for(let fe=0;fe<b.length;fe++)t.bindFramebuffer(i.FRAMEBUFFER,xe.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+fe,i.RENDERBUFFER,null),t.bindFramebuffer(i.FRAMEBUFFER,xe.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+fe,i.TEXTURE_2D,null,0);t.bindFramebuffer(i.READ_FRAMEBUFFER,xe.__webglMultisampledFramebuffer),C.texture.mipmaps.length>0?t.bindFramebuffer(i.DRAW_FRAMEBUFFER,xe.__webglFramebuffer[0]):t.bindFramebuffer(i.DRAW_FRAMEBUFFER,xe.__webglFramebuffer);for(let fe=0;fe<b.length;fe++){if(C.resolveDepthBuffer&&(C.depthBuffer&&(re|=i.DEPTH_BUFFER_BIT),C.stencilBuffer&&C.resolveStencilBuffer&&(re|=i.STENCIL_BUFFER_BIT)),ee){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,xe.__webglColorRenderbuffer[fe]);let U=n.get(b[fe]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,U,0)}i.blitFramebuffer(0,0,q,he,0,0,q,he,re,i.NEAREST),l===!0&&(Ce.length=0,Ce.push(i.COLOR_ATTACHMENT0+fe),C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&Ce.push(ve),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Ce))}if(t.bindFramebuffer(i.READ_FRAMEBUFFER,null),t.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),ee)for(let fe=0;fe<b.length;fe++){t.bindFramebuffer(i.FRAMEBUFFER,xe.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+fe,i.RENDERBUFFER,xe.__webglColorRenderbuffer[fe]);let U=n.get(b[fe]).__webglTexture;t.bindFramebuffer(i.FRAMEBUFFER,xe.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+fe,i.TEXTURE_2D,U,0)}t.bindFramebuffer(i.DRAW_FRAMEBUFFER,xe.__webglMultisampledFramebuffer)}else if(C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&l){let b=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[b])}}}function lt(C){return Math.min(s.maxSamples,C.samples)}function we(C){let b=n.get(C);return C.samples>0&&e.has("WEBGL_multisampled_render_to_texture")===!0&&b.__useRenderToTexture!==!1}function Ot(C){let b=o.render.frame;h.get(C)!==b&&(h.set(C,b),C.update())}function Ge(C,b){let q=C.colorSpace,he=C.format,re=C.type;return C.isCompressedTexture===!0||C.isVideoTexture===!0||q!==Ca&&q!==zs&&(vt.getTransfer(q)===Ct?(he!==ts||re!==ui)&&Ye("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):tt("WebGLTextures: Unsupported texture color space:",q)),b}function qe(C){return typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement?(c.width=C.naturalWidth||C.width,c.height=C.naturalHeight||C.height):typeof VideoFrame<"u"&&C instanceof VideoFrame?(c.width=C.displayWidth,c.height=C.displayHeight):(c.width=C.width,c.height=C.height),c}this.allocateTextureUnit=ce,this.resetTextureUnits=J,this.getTextureUnits=ne,this.setTextureUnits=ue,this.setTexture2D=pe,this.setTexture2DArray=me,this.setTexture3D=ye,this.setTextureCube=ge,this.rebindTextures=rn,this.setupRenderTarget=mn,this.updateRenderTargetMipmap=O,this.updateMultisampleRenderTarget=Ke,this.setupDepthRenderbuffer=Tn,this.setupFrameBufferTexture=Dt,this.useMultisampledRTT=we,this.dispose=F}function v1(i,e){function t(n,s=zs){let r,o=vt.getTransfer(s);if(n===ui)return i.UNSIGNED_BYTE;if(n===oh)return i.UNSIGNED_SHORT_4_4_4_4;if(n===ah)return i.UNSIGNED_SHORT_5_5_5_1;if(n===af)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===lf)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===rf)return i.BYTE;if(n===of)return i.SHORT;if(n===zo)return i.UNSIGNED_SHORT;if(n===rh)return i.INT;if(n===Qi)return i.UNSIGNED_INT;if(n===ki)return i.FLOAT;if(n===es)return i.HALF_FLOAT;if(n===cf)return i.ALPHA;if(n===hf)return i.RGB;if(n===ts)return i.RGBA;if(n===Ns)return i.DEPTH_COMPONENT;if(n===Bs)return i.DEPTH_STENCIL;if(n===lh)return i.RED;if(n===ch)return i.RED_INTEGER;if(n===dr)return i.RG;if(n===hh)return i.RG_INTEGER;if(n===uh)return i.RGBA_INTEGER;if(n===ja||n===Qa||n===el||n===tl)if(o===Ct)if(r=e.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===ja)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===el)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===tl)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=e.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===ja)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===el)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===tl)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===dh||n===fh||n===ph||n===mh)if(r=e.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===dh)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===fh)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===ph)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===mh)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===gh||n===yh||n===_h||n===vh||n===xh||n===nl||n===bh)if(r=e.get("WEBGL_compressed_texture_etc"),r!==null){if(n===gh||n===yh)return o===Ct?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===_h)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===vh)return r.COMPRESSED_R11_EAC;if(n===xh)return r.COMPRESSED_SIGNED_R11_EAC;if(n===nl)return r.COMPRESSED_RG11_EAC;if(n===bh)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===Sh||n===Mh||n===wh||n===Th||n===Eh||n===Ah||n===Rh||n===Ch||n===Ph||n===Ih||n===Lh||n===Nh||n===Dh||n===Fh)if(r=e.get("WEBGL_compressed_texture_astc"),r!==null){if(n===Sh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===Mh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===wh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===Th)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===Eh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===Ah)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===Rh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===Ch)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===Ph)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===Ih)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===Lh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===Nh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===Dh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===Fh)return o===Ct?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===Uh||n===Oh||n===kh)if(r=e.get("EXT_texture_compression_bptc"),r!==null){if(n===Uh)return o===Ct?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===Oh)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===kh)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===Bh||n===zh||n===il||n===Vh)if(r=e.get("EXT_texture_compression_rgtc"),r!==null){if(n===Bh)return r.COMPRESSED_RED_RGTC1_EXT;if(n===zh)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===il)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===Vh)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===Ur?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:t}}var x1=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,b1=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,Lf=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(e,t){if(this.texture===null){let n=new Va(e.texture);(e.depthNear!==t.depthNear||e.depthFar!==t.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=n}}getMesh(e){if(this.texture!==null&&this.mesh===null){let t=e.cameras[0].viewport,n=new Fi({vertexShader:x1,fragmentShader:b1,uniforms:{depthColor:{value:this.texture},depthWidth:{value:t.z},depthHeight:{value:t.w}}});this.mesh=new Zt(new Pr(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Nf=class extends Ki{constructor(e,t){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,d=null,u=null,f=null,g=null,y=typeof XRWebGLBinding<"u",p=new Lf,m={},x=t.getContextAttributes(),A=null,S=null,R=[],M=[],_=new Ze,E=null,k=null,N=new si;N.viewport=new tn;let L=new si;L.viewport=new tn;let B=[N,L],V=new eh,P=null,F=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(Q){let pe=R[Q];return pe===void 0&&(pe=new Co,R[Q]=pe),pe.getTargetRaySpace()},this.getControllerGrip=function(Q){let pe=R[Q];return pe===void 0&&(pe=new Co,R[Q]=pe),pe.getGripSpace()},this.getHand=function(Q){let pe=R[Q];return pe===void 0&&(pe=new Co,R[Q]=pe),pe.getHandSpace()};function X(Q){let pe=M.indexOf(Q.inputSource);if(pe===-1)return;let me=R[pe];me!==void 0&&(me.update(Q.inputSource,Q.frame,c||o),me.dispatchEvent({type:Q.type,data:Q.inputSource}))}function G(){s.removeEventListener("select",X),s.removeEventListener("selectstart",X),s.removeEventListener("selectend",X),s.removeEventListener("squeeze",X),s.removeEventListener("squeezestart",X),s.removeEventListener("squeezeend",X),s.removeEventListener("end",G),s.removeEventListener("inputsourceschange",oe);for(let Q=0;Q<R.length;Q++){let pe=M[Q];pe!==null&&(M[Q]=null,R[Q].disconnect(pe))}P=null,F=null,p.reset();for(let Q in m)delete m[Q];if(e.setRenderTarget(A),f=null,u=null,d=null,s=null,S=null,ce.stop(),n.isPresenting=!1,e.setPixelRatio(E),e.setSize(_.width,_.height,!1),k!==null){let Q=k.camera;Q.fov=k.fov,Q.zoom=k.zoom,Q.updateProjectionMatrix(),k=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(Q){r=Q,n.isPresenting===!0&&Ye("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(Q){a=Q,n.isPresenting===!0&&Ye("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(Q){c=Q},this.getBaseLayer=function(){return u!==null?u:f},this.getBinding=function(){return d===null&&y&&(d=new XRWebGLBinding(s,t)),d},this.getFrame=function(){return g},this.getSession=function(){return s},this.setSession=async function(Q){if(s=Q,s!==null){if(A=e.getRenderTarget(),s.addEventListener("select",X),s.addEventListener("selectstart",X),s.addEventListener("selectend",X),s.addEventListener("squeeze",X),s.addEventListener("squeezestart",X),s.addEventListener("squeezeend",X),s.addEventListener("end",G),s.addEventListener("inputsourceschange",oe),x.xrCompatible!==!0&&await t.makeXRCompatible(),E=e.getPixelRatio(),e.getSize(_),y&&"createProjectionLayer"in XRWebGLBinding.prototype){let me=null,ye=null,ge=null;x.depth&&(ge=x.stencil?t.DEPTH24_STENCIL8:t.DEPTH_COMPONENT24,me=x.stencil?Bs:Ns,ye=x.stencil?Ur:Qi);let Ve={colorFormat:t.RGBA8,depthFormat:ge,scaleFactor:r};d=this.getBinding(),u=d.createProjectionLayer(Ve),s.updateRenderState({layers:[u]}),e.setPixelRatio(1),e.setSize(u.textureWidth,u.textureHeight,!1),S=new Si(u.textureWidth,u.textureHeight,{format:ts,type:ui,depthTexture:new Us(u.textureWidth,u.textureHeight,ye,void 0,void 0,void 0,void 0,void 0,void 0,me),stencilBuffer:x.stencil,colorSpace:e.outputColorSpace,samples:x.antialias?4:0,resolveDepthBuffer:u.ignoreDepthValues===!1,resolveStencilBuffer:u.ignoreDepthValues===!1,storeMultisampledDepthBuffer:u.ignoreDepthValues===!1,storeMultisampledStencilBuffer:u.ignoreDepthValues===!1})}else{let me={antialias:x.antialias,alpha:!0,depth:x.depth,stencil:x.stencil,framebufferScaleFactor:r};f=new XRWebGLLayer(s,t,me),s.updateRenderState({baseLayer:f}),e.setPixelRatio(1),e.setSize(f.framebufferWidth,f.framebufferHeight,!1),S=new Si(f.framebufferWidth,f.framebufferHeight,{format:ts,type:ui,colorSpace:e.outputColorSpace,stencilBuffer:x.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}S.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),ce.setContext(s),ce.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return p.getDepthTexture()};function oe(Q){for(let pe=0;pe<Q.removed.length;pe++){let me=Q.removed[pe],ye=M.indexOf(me);ye>=0&&(M[ye]=null,R[ye].disconnect(me))}for(let pe=0;pe<Q.added.length;pe++){let me=Q.added[pe],ye=M.indexOf(me);if(ye===-1){for(let Ve=0;Ve<R.length;Ve++)if(Ve>=M.length){M.push(me),ye=Ve;break}else if(M[Ve]===null){M[Ve]=me,ye=Ve;break}if(ye===-1)break}let ge=R[ye];ge&&ge.connect(me)}}function $(Q,pe){pe===null?Q.matrixWorld.copy(Q.matrix):Q.matrixWorld.multiplyMatrices(pe.matrixWorld,Q.matrix),Q.matrixWorldInverse.copy(Q.matrixWorld).invert()}this.updateCamera=function(Q){if(s===null)return;let pe=Q.near,me=Q.far;p.texture!==null&&(p.depthNear>0&&(pe=p.depthNear),p.depthFar>0&&(me=p.depthFar)),V.near=L.near=N.near=pe,V.far=L.far=N.far=me,(P!==V.near||F!==V.far)&&(s.updateRenderState({depthNear:V.near,depthFar:V.far}),P=V.near,F=V.far),V.layers.mask=Q.layers.mask|6,N.layers.mask=V.layers.mask&-5,L.layers.mask=V.layers.mask&-3;let ye=Q.parent,ge=V.cameras;$(V,ye);for(let Ve=0;Ve<ge.length;Ve++)$(ge[Ve],ye);V.projectionMatrix.copy(N.projectionMatrix),V.projectionMatrixInverse.copy(N.projectionMatrixInverse),k===null&&Q.isPerspectiveCamera&&(k={camera:Q,fov:Q.fov,zoom:Q.zoom}),J(Q,V,ye)};function J(Q,pe,me){me===null?Q.matrix.copy(pe.matrixWorld):(Q.matrix.copy(me.matrixWorld),Q.matrix.invert(),Q.matrix.multiply(pe.matrixWorld)),Q.matrix.decompose(Q.position,Q.quaternion,Q.scale),Q.updateMatrixWorld(!0),Q.projectionMatrix.copy(pe.projectionMatrix),Q.projectionMatrixInverse.copy(pe.projectionMatrixInverse),Q.isPerspectiveCamera&&(Q.fov=Eo*2*Math.atan(1/Q.projectionMatrix.elements[5]),Q.zoom=1)}this.getCamera=function(){return V},this.getFoveation=function(){if(!(u===null&&f===null))return l},this.setFoveation=function(Q){l=Q,u!==null&&(u.fixedFoveation=Q),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=Q)},this.hasDepthSensing=function(){return p.texture!==null},this.getDepthSensingMesh=function(){return p.getMesh(V)},this.getCameraTexture=function(Q){return m[Q]};let ne=null;function ue(Q,pe){if(h=pe.getViewerPose(c||o),g=pe,h!==null){let me=h.views;f!==null&&(e.setRenderTargetFramebuffer(S,f.framebuffer),e.setRenderTarget(S));let ye=!1;me.length!==V.cameras.length&&(V.cameras.length=0,ye=!0);for(let Ue=0;Ue<me.length;Ue++){let rt=me[Ue],ct=null;if(f!==null)ct=f.getViewport(rt);else{let jt=d.getViewSubImage(u,rt);ct=jt.viewport,Ue===0&&(e.setRenderTargetTextures(S,jt.colorTexture,jt.depthStencilTexture),e.setRenderTarget(S))}let ot=B[Ue];ot===void 0&&(ot=new si,ot.layers.enable(Ue),ot.viewport=new tn,B[Ue]=ot),ot.matrix.fromArray(rt.transform.matrix),ot.matrix.decompose(ot.position,ot.quaternion,ot.scale),ot.projectionMatrix.fromArray(rt.projectionMatrix),ot.projectionMatrixInverse.copy(ot.projectionMatrix).invert(),ot.viewport.set(ct.x,ct.y,ct.width,ct.height),Ue===0&&(V.matrix.copy(ot.matrix),V.matrix.decompose(V.position,V.quaternion,V.scale)),ye===!0&&V.cameras.push(ot)}let ge=s.enabledFeatures;if(ge&&ge.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&y){d=n.getBinding();let Ue=d.getDepthInformation(me[0]);Ue&&Ue.isValid&&Ue.texture&&p.init(Ue,s.renderState)}if(ge&&ge.includes("camera-access")&&y){e.state.unbindTexture(),d=n.getBinding();for(let Ue=0;Ue<me.length;Ue++){let rt=me[Ue].camera;if(rt){let ct=m[rt];ct||(ct=new Va,m[rt]=ct);let ot=d.getCameraImage(rt);ct.sourceTexture=ot}}}}for(let me=0;me<R.length;me++){let ye=M[me],ge=R[me];ye!==null&&ge!==void 0&&ge.update(ye,pe,c||o)}ne&&ne(Q,pe),pe.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:pe}),g=null}let ce=new M0;ce.setAnimationLoop(ue),this.setAnimationLoop=function(Q){ne=Q},this.dispose=function(){}}},S1=new Mt,N0=new st;N0.set(-1,0,0,0,1,0,0,0,1);function M1(i,e){function t(p,m){p.matrixAutoUpdate===!0&&p.updateMatrix(),m.value.copy(p.matrix)}function n(p,m){m.color.getRGB(p.fogColor.value,xf(i)),m.isFog?(p.fogNear.value=m.near,p.fogFar.value=m.far):m.isFogExp2&&(p.fogDensity.value=m.density)}function s(p,m,x,A,S){m.isNodeMaterial?m.uniformsNeedUpdate=!1:m.isMeshBasicMaterial?r(p,m):m.isMeshLambertMaterial?(r(p,m),m.envMap&&(p.envMapIntensity.value=m.envMapIntensity)):m.isMeshToonMaterial?(r(p,m),d(p,m)):m.isMeshPhongMaterial?(r(p,m),h(p,m),m.envMap&&(p.envMapIntensity.value=m.envMapIntensity)):m.isMeshStandardMaterial?(r(p,m),u(p,m),m.isMeshPhysicalMaterial&&f(p,m,S)):m.isMeshMatcapMaterial?(r(p,m),g(p,m)):m.isMeshDepthMaterial?r(p,m):m.isMeshDistanceMaterial?(r(p,m),y(p,m)):m.isMeshNormalMaterial?r(p,m):m.isLineBasicMaterial?(o(p,m),m.isLineDashedMaterial&&a(p,m)):m.isPointsMaterial?l(p,m,x,A):m.isSpriteMaterial?c(p,m):m.isShadowMaterial?(p.color.value.copy(m.color),p.opacity.value=m.opacity):m.isShaderMaterial&&(m.uniformsNeedUpdate=!1)}function r(p,m){p.opacity.value=m.opacity,m.color&&p.diffuse.value.copy(m.color),m.emissive&&p.emissive.value.copy(m.emissive).multiplyScalar(m.emissiveIntensity),m.map&&(p.map.value=m.map,t(m.map,p.mapTransform)),m.alphaMap&&(p.alphaMap.value=m.alphaMap,t(m.alphaMap,p.alphaMapTransform)),m.bumpMap&&(p.bumpMap.value=m.bumpMap,t(m.bumpMap,p.bumpMapTransform),p.bumpScale.value=m.bumpScale,m.side===ai&&(p.bumpScale.value*=-1)),m.normalMap&&(p.normalMap.value=m.normalMap,t(m.normalMap,p.normalMapTransform),p.normalScale.value.copy(m.normalScale),m.side===ai&&p.normalScale.value.negate()),m.displacementMap&&(p.displacementMap.value=m.displacementMap,t(m.displacementMap,p.displacementMapTransform),p.displacementScale.value=m.displacementScale,p.displacementBias.value=m.displacementBias),m.emissiveMap&&(p.emissiveMap.value=m.emissiveMap,t(m.emissiveMap,p.emissiveMapTransform)),m.specularMap&&(p.specularMap.value=m.specularMap,t(m.specularMap,p.specularMapTransform)),m.alphaTest>0&&(p.alphaTest.value=m.alphaTest);let x=e.get(m),A=x.envMap,S=x.envMapRotation;A&&(p.envMap.value=A,p.envMapRotation.value.setFromMatrix4(S1.makeRotationFromEuler(S)).transpose(),A.isCubeTexture&&A.isRenderTargetTexture===!1&&p.envMapRotation.value.premultiply(N0),p.reflectivity.value=m.reflectivity,p.ior.value=m.ior,p.refractionRatio.value=m.refractionRatio),m.lightMap&&(p.lightMap.value=m.lightMap,p.lightMapIntensity.value=m.lightMapIntensity,t(m.lightMap,p.lightMapTransform)),m.aoMap&&(p.aoMap.value=m.aoMap,p.aoMapIntensity.value=m.aoMapIntensity,t(m.aoMap,p.aoMapTransform))}function o(p,m){p.diffuse.value.copy(m.color),p.opacity.value=m.opacity,m.map&&(p.map.value=m.map,t(m.map,p.mapTransform))}function a(p,m){p.dashSize.value=m.dashSize,p.totalSize.value=m.dashSize+m.gapSize,p.scale.value=m.scale}function l(p,m,x,A){p.diffuse.value.copy(m.color),p.opacity.value=m.opacity,p.size.value=m.size*x,p.scale.value=A*.5,m.map&&(p.map.value=m.map,t(m.map,p.uvTransform)),m.alphaMap&&(p.alphaMap.value=m.alphaMap,t(m.alphaMap,p.alphaMapTransform)),m.alphaTest>0&&(p.alphaTest.value=m.alphaTest)}function c(p,m){p.diffuse.value.copy(m.color),p.opacity.value=m.opacity,p.rotation.value=m.rotation,m.map&&(p.map.value=m.map,t(m.map,p.mapTransform)),m.alphaMap&&(p.alphaMap.value=m.alphaMap,t(m.alphaMap,p.alphaMapTransform)),m.alphaTest>0&&(p.alphaTest.value=m.alphaTest)}function h(p,m){p.specular.value.copy(m.specular),p.shininess.value=Math.max(m.shininess,1e-4)}function d(p,m){m.gradientMap&&(p.gradientMap.value=m.gradientMap)}function u(p,m){p.metalness.value=m.metalness,m.metalnessMap&&(p.metalnessMap.value=m.metalnessMap,t(m.metalnessMap,p.metalnessMapTransform)),p.roughness.value=m.roughness,m.roughnessMap&&(p.roughnessMap.value=m.roughnessMap,t(m.roughnessMap,p.roughnessMapTransform)),m.envMap&&(p.envMapIntensity.value=m.envMapIntensity)}function f(p,m,x){p.ior.value=m.ior,m.diffuseRoughness>0&&(p.diffuseRoughness.value=m.diffuseRoughness,m.diffuseRoughnessMap&&(p.diffuseRoughnessMap.value=m.diffuseRoughnessMap,t(m.diffuseRoughnessMap,p.diffuseRoughnessMapTransform))),m.sheen>0&&(p.sheenColor.value.copy(m.sheenColor).multiplyScalar(m.sheen),p.sheenRoughness.value=m.sheenRoughness,m.sheenColorMap&&(p.sheenColorMap.value=m.sheenColorMap,t(m.sheenColorMap,p.sheenColorMapTransform)),m.sheenRoughnessMap&&(p.sheenRoughnessMap.value=m.sheenRoughnessMap,t(m.sheenRoughnessMap,p.sheenRoughnessMapTransform))),m.clearcoat>0&&(p.clearcoat.value=m.clearcoat,p.clearcoatRoughness.value=m.clearcoatRoughness,m.clearcoatMap&&(p.clearcoatMap.value=m.clearcoatMap,t(m.clearcoatMap,p.clearcoatMapTransform)),m.clearcoatRoughnessMap&&(p.clearcoatRoughnessMap.value=m.clearcoatRoughnessMap,t(m.clearcoatRoughnessMap,p.clearcoatRoughnessMapTransform)),m.clearcoatNormalMap&&(p.clearcoatNormalMap.value=m.clearcoatNormalMap,t(m.clearcoatNormalMap,p.clearcoatNormalMapTransform),p.clearcoatNormalScale.value.copy(m.clearcoatNormalScale),m.side===ai&&p.clearcoatNormalScale.value.negate())),m.dispersion>0&&(p.dispersion.value=m.dispersion),m.retroreflectivity>0&&(p.retroreflectivity.value=m.retroreflectivity),m.iridescence>0&&(p.iridescence.value=m.iridescence,p.iridescenceIOR.value=m.iridescenceIOR,p.iridescenceThicknessMinimum.value=m.iridescenceThicknessMinimum,p.iridescenceThicknessMaximum.value=m.iridescenceThicknessMaximum,m.iridescenceMap&&(p.iridescenceMap.value=m.iridescenceMap,t(m.iridescenceMap,p.iridescenceMapTransform)),m.iridescenceThicknessMap&&(p.iridescenceThicknessMap.value=m.iridescenceThicknessMap,t(m.iridescenceThicknessMap,p.iridescenceThicknessMapTransform))),m.transmission>0&&(p.transmission.value=m.transmission,p.transmissionSamplerMap.value=x.texture,p.transmissionSamplerSize.value.set(x.width,x.height),m.transmissionMap&&(p.transmissionMap.value=m.transmissionMap,t(m.transmissionMap,p.transmissionMapTransform)),p.thickness.value=m.thickness,m.thicknessMap&&(p.thicknessMap.value=m.thicknessMap,t(m.thicknessMap,p.thicknessMapTransform)),p.attenuationDistance.value=m.attenuationDistance,p.attenuationColor.value.copy(m.attenuationColor)),m.anisotropy>0&&(p.anisotropyVector.value.set(m.anisotropy*Math.cos(m.anisotropyRotation),m.anisotropy*Math.sin(m.anisotropyRotation)),m.anisotropyMap&&(p.anisotropyMap.value=m.anisotropyMap,t(m.anisotropyMap,p.anisotropyMapTransform))),p.specularIntensity.value=m.specularIntensity,p.specularColor.value.copy(m.specularColor),m.specularColorMap&&(p.specularColorMap.value=m.specularColorMap,t(m.specularColorMap,p.specularColorMapTransform)),m.specularIntensityMap&&(p.specularIntensityMap.value=m.specularIntensityMap,t(m.specularIntensityMap,p.specularIntensityMapTransform))}function g(p,m){m.matcap&&(p.matcap.value=m.matcap)}function y(p,m){let x=e.get(m).light;p.referencePosition.value.setFromMatrixPosition(x.matrixWorld),p.nearDistance.value=x.shadow.camera.near,p.farDistance.value=x.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function w1(i,e,t,n){let s={},r={};function o(x,A){let S=A.program;n.uniformBlockBinding(x,S,s[x.id])}function a(x,A){let S=s[x.id];S===void 0&&(g(x),S=l(x),s[x.id]=S,x.addEventListener("dispose",p));let R=A.program;n.updateUBOMapping(x,R);let M=e.render.frame;r[x.id]!==M&&(c(x),r[x.id]=M)}function l(x){let A=i.createBuffer(),S=x.__size,R=x.usage;return i.bindBuffer(i.UNIFORM_BUFFER,A),i.bufferData(i.UNIFORM_BUFFER,S,R),i.bindBuffer(i.UNIFORM_BUFFER,null),A}function c(x){let A=s[x.id],S=x.uniforms,R=x.__cache;i.bindBuffer(i.UNIFORM_BUFFER,A);for(let M=0,_=S.length;M<_;M++){let E=S[M];if(Array.isArray(E))for(let k=0,N=E.length;k<N;k++)h(E[k],M,k,R);else h(E,M,0,R)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function h(x,A,S,R){if(u(x,A,S,R)===!0){let M=x.__offset,_=x.value;if(Array.isArray(_)){let E=0;for(let k=0;k<_.length;k++){let N=_[k],L=y(N,!0);d(N,x.__data,E),E+=L.storage/Float32Array.BYTES_PER_ELEMENT}}else d(_,x.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,M,x.__data)}}function d(x,A,S){typeof x=="number"||typeof x=="boolean"?A[S]=x:x.isMatrix3?(A[S]=x.elements[0],A[S+1]=x.elements[1],A[S+2]=x.elements[2],A[S+3]=0,A[S+4]=x.elements[3],A[S+5]=x.elements[4],A[S+6]=x.elements[5],A[S+7]=0,A[S+8]=x.elements[6],A[S+9]=x.elements[7],A[S+10]=x.elements[8],A[S+11]=0):ArrayBuffer.isView(x)?A.set(x.subarray(0,A.length-S),S):x.toArray(A,S)}function u(x,A,S,R){let M=x.value,_=A+"_"+S;if(Array.isArray(M)){R[_]===void 0&&(R[_]=[]);let E=R[_],k=!1;for(let N=0;N<M.length;N++)f(M[N],E,N)===!0&&(k=!0);return k}return f(M,R,_)}function f(x,A,S){if(A[S]===void 0)return typeof x=="number"||typeof x=="boolean"?A[S]=x:ArrayBuffer.isView(x)?A[S]=x.slice():A[S]=x.clone(),!0;{let R=A[S];if(typeof x=="number"||typeof x=="boolean"){if(R!==x)return A[S]=x,!0}else{if(ArrayBuffer.isView(x))return!0;if(R.equals(x)===!1)return R.copy(x),!0}}return!1}function g(x){let A=x.uniforms,S=0,R=16;for(let _=0,E=A.length;_<E;_++){let k=Array.isArray(A[_])?A[_]:[A[_]];for(let N=0,L=k.length;N<L;N++){let B=k[N],V=Array.isArray(B.value)?B.value:[B.value],P=Array.isArray(A[_])||Array.isArray(B.value),F=S;for(let G=0,oe=V.length;G<oe;G++){let $=V[G],J=y($,P),ne=S%R,ue=ne%J.boundary,ce=ne+ue;S+=ue,ce!==0&&R-ce<J.storage&&(S+=R-ce),G===0&&(F=S),S+=J.storage}let X=B.type==="int"?Int32Array:B.type==="uint"?Uint32Array:Float32Array;B.__data=new X((S-F)/Float32Array.BYTES_PER_ELEMENT),B.__offset=F}}let M=S%R;return M>0&&(S+=R-M),x.__size=S,x.__cache={},this}function y(x,A){let S={boundary:0,storage:0};return typeof x=="number"||typeof x=="boolean"?(S.boundary=4,S.storage=4):x.isVector2?(S.boundary=8,S.storage=8):x.isVector3||x.isColor?(S.boundary=16,S.storage=12):x.isVector4?(S.boundary=16,S.storage=16):x.isMatrix3?(S.boundary=16,S.storage=48):x.isMatrix4?(S.boundary=16,S.storage=64):x.isTexture?Ye("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(x)?(S.boundary=16,S.storage=x.byteLength):Ye("WebGLRenderer: Unsupported uniform value type.",x),A===!0&&(S.boundary=16,S.storage=Math.ceil(S.storage/16)*16),S}function p(x){let A=x.target;A.removeEventListener("dispose",p),i.deleteBuffer(s[A.id]),delete s[A.id],delete r[A.id]}function m(){for(let x in s)i.deleteBuffer(s[x]);s={},r={}}return{bind:o,update:a,dispose:m}}var T1=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),_s=null;function E1(){return _s===null&&(_s=new Ua(T1,16,16,dr,es),_s.name="DFG_LUT",_s.minFilter=ri,_s.magFilter=ri,_s.wrapS=ms,_s.wrapT=ms,_s.generateMipmaps=!1,_s.needsUpdate=!0),_s}var qh=class{constructor(e={}){let{canvas:t=qg(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:d=!1,reversedDepthBuffer:u=!1,outputBufferType:f=ui}=e;this.isWebGLRenderer=!0;let g;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");g=n.getContextAttributes().alpha}else g=o;let y=f,p=new Set([uh,hh,ch]),m=new Set([ui,Qi,zo,Ur,oh,ah]),x=new Uint32Array(4),A=new Int32Array(4),S={textures:[],min:[],max:[],resolution:[]},R=null,M=null,_=[],E=[],k=null;this.domElement=t,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=Oi,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let N=this,L=!1,B=null,V=null,P=null,F=null;this._outputColorSpace=bi;let X=0,G=0,oe=null,$=-1,J=null,ne=new tn,ue=new tn,ce=null,Q=new it(0),pe=0,me=t.width,ye=t.height,ge=1,Ve=null,Je=null,Ue=new tn(0,0,me,ye),rt=new tn(0,0,me,ye),ct=!1,ot=new or,jt=new Oc,Gt=!1,pn=!1,Dt=new Mt,Dn=new W,bt=new tn,Tn={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},rn=!1;function mn(){return oe===null?ge:1}let O=n;function Ce(T,z){return t.getContext(T,z)}let Ke,lt,we,Ot,Ge,qe,C,b,q,he,re,ve,xe,ee,ie,fe,U,se,te,Te,_e,Me,He;try{let T={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:d};if("setAttribute"in t&&t.setAttribute("data-engine",`three.js r${"187"}`),t.addEventListener("webglcontextlost",ke,!1),t.addEventListener("webglcontextrestored",et,!1),t.addEventListener("webglcontextcreationerror",Re,!1),O===null){let z="webgl2";if(O=Ce(z,T),O===null)throw Ce(z)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}Qe()}catch(T){throw t.removeEventListener("webglcontextlost",ke,!1),t.removeEventListener("webglcontextrestored",et,!1),t.removeEventListener("webglcontextcreationerror",Re,!1),tt("WebGLRenderer: "+T.message),T}function Qe(){Ke=new OM(O),Ke.init(),_e=new v1(O,Ke),lt=new EM(O,Ke,e,_e),we=new y1(O,Ke),lt.reversedDepthBuffer&&u&&we.buffers.depth.setReversed(!0),V=O.createFramebuffer(),P=O.createFramebuffer(),F=O.createFramebuffer(),Ot=new zM(O),Ge=new i1,qe=new _1(O,Ke,we,Ge,lt,_e,Ot),C=new UM(N),b=new Gx(O),Me=new wM(O,b),q=new kM(O,b,Ot,Me),he=new GM(O,q,b,Me,Ot),se=new VM(O,lt,qe),ie=new AM(Ge),re=new n1(N,C,Ke,lt,Me,ie),ve=new M1(N,Ge),xe=new r1,ee=new u1(Ke),U=new MM(N,C,we,he,g,l),fe=new g1(N,he,lt),He=new w1(O,Ot,lt,we),te=new TM(O,Ke,Ot),Te=new BM(O,Ke,Ot),Ot.programs=re.programs,N.capabilities=lt,N.extensions=Ke,N.properties=Ge,N.renderLists=xe,N.shadowMap=fe,N.state=we,N.info=Ot}y!==ui&&(k=new WM(y,t.width,t.height,a,s,r));let le=new Nf(N,O);this.xr=le,this.getContext=function(){return O},this.getContextAttributes=function(){return O.getContextAttributes()},this.forceContextLoss=function(){let T=Ke.get("WEBGL_lose_context");T&&T.loseContext()},this.forceContextRestore=function(){let T=Ke.get("WEBGL_lose_context");T&&T.restoreContext()},this.getPixelRatio=function(){return ge},this.setPixelRatio=function(T){T!==void 0&&(ge=T,this.setSize(me,ye,!1))},this.getSize=function(T){return T.set(me,ye)},this.setSize=function(T,z,j=!0){if(le.isPresenting){Ye("WebGLRenderer: Can't change size while VR device is presenting.");return}me=T,ye=z,t.width=Math.floor(T*ge),t.height=Math.floor(z*ge),j===!0&&(t.style.width=T+"px",t.style.height=z+"px"),k!==null&&k.setSize(t.width,t.height),this.setViewport(0,0,T,z)},this.getDrawingBufferSize=function(T){return T.set(me*ge,ye*ge).floor()},this.setDrawingBufferSize=function(T,z,j){me=T,ye=z,ge=j,t.width=Math.floor(T*j),t.height=Math.floor(z*j),this.setViewport(0,0,T,z)},this.setEffects=function(T){if(y===ui){tt("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(T){for(let z=0;z<T.length;z++)if(T[z].isOutputPass===!0){Ye("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}k.setEffects(T||[])},this.getCurrentViewport=function(T){return T.copy(ne)},this.getViewport=function(T){return T.copy(Ue)},this.setViewport=function(T,z,j,Y){T.isVector4?Ue.set(T.x,T.y,T.z,T.w):Ue.set(T,z,j,Y),we.viewport(ne.copy(Ue).multiplyScalar(mn()).round())},this.getScissor=function(T){return T.copy(rt)},this.setScissor=function(T,z,j,Y){T.isVector4?rt.set(T.x,T.y,T.z,T.w):rt.set(T,z,j,Y),we.scissor(ue.copy(rt).multiplyScalar(mn()).round())},this.getScissorTest=function(){return ct},this.setScissorTest=function(T){we.setScissorTest(ct=T)},this.setOpaqueSort=function(T){Ve=T},this.setTransparentSort=function(T){Je=T},this.getClearColor=function(T){return T.copy(U.getClearColor())},this.setClearColor=function(){U.setClearColor(...arguments)},this.getClearAlpha=function(){return U.getClearAlpha()},this.setClearAlpha=function(){U.setClearAlpha(...arguments)},this.clear=function(T=!0,z=!0,j=!0){let Y=0;if(T){let Z=!1;if(oe!==null){let Ee=oe.texture.format;Z=p.has(Ee)}if(Z){let Ee=oe.texture.type,Pe=m.has(Ee),Ae=U.getClearColor(),Ie=U.getClearAlpha(),ze=Ae.r,nt=Ae.g,ft=Ae.b;Pe?(x[0]=ze,x[1]=nt,x[2]=ft,x[3]=Ie,O.clearBufferuiv(O.COLOR,0,x)):(A[0]=ze,A[1]=nt,A[2]=ft,A[3]=Ie,O.clearBufferiv(O.COLOR,0,A))}else Y|=O.COLOR_BUFFER_BIT}z&&(Y|=O.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),j&&(Y|=O.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),Y!==0&&O.clear(Y)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(T){T.setRenderer(this),B=T},this.dispose=function(){t.removeEventListener("webglcontextlost",ke,!1),t.removeEventListener("webglcontextrestored",et,!1),t.removeEventListener("webglcontextcreationerror",Re,!1),U.dispose(),xe.dispose(),ee.dispose(),qe.dispose(),Ge.dispose(),C.dispose(),he.dispose(),q.dispose(),Me.dispose(),He.dispose(),re.dispose(),le.dispose(),le.removeEventListener("sessionstart",Al),le.removeEventListener("sessionend",as),bs.stop()};function ke(T){T.preventDefault(),mf("WebGLRenderer: Context Lost."),L=!0}function et(){mf("WebGLRenderer: Context Restored."),L=!1;let T=Ot.autoReset,z=fe.enabled,j=fe.autoUpdate,Y=fe.needsUpdate,Z=fe.type;Qe(),Ot.autoReset=T,fe.enabled=z,fe.autoUpdate=j,fe.needsUpdate=Y,fe.type=Z}function Re(T){tt("WebGLRenderer: A WebGL context could not be created. Reason: ",T.statusMessage)}function ht(T){let z=T.target;z.removeEventListener("dispose",ht),Wt(z)}function Wt(T){jn(T),Ge.remove(T)}function jn(T){let z=Ge.get(T).programs;z!==void 0&&(z.forEach(function(j){re.releaseProgram(j)}),T.isShaderMaterial&&re.releaseShaderCache(T))}this.renderBufferDirect=function(T,z,j,Y,Z,Ee){z===null&&(z=Tn);let Pe=Z.isMesh&&Z.matrixWorld.determinantAffine()<0,Ae=sa(T,z,j,Y,Z);we.setMaterial(Y,Pe);let Ie=j.index,ze=1;if(Y.wireframe===!0){if(Ie=q.getWireframeAttribute(j),Ie===void 0)return;ze=2}let nt=j.drawRange,ft=j.attributes.position,Be=nt.start*ze,pt=(nt.start+nt.count)*ze;Ee!==null&&(Be=Math.max(Be,Ee.start*ze),pt=Math.min(pt,(Ee.start+Ee.count)*ze)),Ie!==null?(Be=Math.max(Be,0),pt=Math.min(pt,Ie.count)):ft!=null&&(Be=Math.max(Be,0),pt=Math.min(pt,ft.count));let sn=pt-Be;if(sn<0||sn===1/0)return;Me.setup(Z,Y,Ae,j,Ie);let It,Lt=te;if(Ie!==null&&(It=b.get(Ie),Lt=Te,Lt.setIndex(It)),Z.isMesh)Y.wireframe===!0?(we.setLineWidth(Y.wireframeLinewidth*mn()),Lt.setMode(O.LINES)):Lt.setMode(O.TRIANGLES);else if(Z.isLine){let En=Y.linewidth;En===void 0&&(En=1),we.setLineWidth(En*mn()),Z.isLineSegments?Lt.setMode(O.LINES):Z.isLineLoop?Lt.setMode(O.LINE_LOOP):Lt.setMode(O.LINE_STRIP)}else Z.isPoints?Lt.setMode(O.POINTS):Z.isSprite&&Lt.setMode(O.TRIANGLES);if(Z.isBatchedMesh)if(Ke.get("WEBGL_multi_draw"))Lt.renderMultiDraw(Z._multiDrawStarts,Z._multiDrawCounts,Z._multiDrawCount);else{let En=Z._multiDrawStarts,Fe=Z._multiDrawCounts,gn=Z._multiDrawCount,_t=Ie?b.get(Ie).bytesPerElement:1,Ms=Ge.get(Y).currentProgram.getUniforms();for(let yn=0;yn<gn;yn++)Ms.setValue(O,"_gl_DrawID",yn),Lt.render(En[yn]/_t,Fe[yn])}else if(Z.isInstancedMesh)Lt.renderInstances(Be,sn,Z.count);else if(j.isInstancedBufferGeometry){let En=j._maxInstanceCount!==void 0?j._maxInstanceCount:1/0,Fe=Math.min(j.instanceCount,En);Lt.renderInstances(Be,sn,Fe)}else Lt.render(Be,sn)};function ta(T,z,j,Y){B!==null&&T.isNodeMaterial&&B.setObject(Y,T),Gt===!0&&ie.setState(T,j,!1),T.transparent===!0&&T.side===Kn&&T.forceSinglePass===!1?(T.side=ai,T.needsUpdate=!0,ls(T,z,Y),T.side=ur,T.needsUpdate=!0,ls(T,z,Y),T.side=Kn):ls(T,z,Y)}this.compile=function(T,z,j=null){j===null&&(j=T),B!==null&&B.renderStart(T,z,j),M=ee.get(j),M.init(z),E.push(M),j.traverseVisible(function(Z){Z.isLight&&Z.layers.test(z.layers)&&(M.pushLight(Z),Z.castShadow&&M.pushShadow(Z))}),T!==j&&T.traverseVisible(function(Z){Z.isLight&&Z.layers.test(z.layers)&&(M.pushLight(Z),Z.castShadow&&M.pushShadow(Z))}),M.setupLights(),B!==null&&B.updateLights(M.state.lightsArray),pn=this.localClippingEnabled,Gt=ie.init(this.clippingPlanes,pn),Gt===!0&&ie.setGlobalState(this.clippingPlanes,z),B!==null&&fe.render(M.state.shadowsArray,j,z);let Y=new Set;return T.traverse(function(Z){if(!(Z.isMesh||Z.isPoints||Z.isLine||Z.isSprite))return;let Ee=Z.material;if(Ee)if(Array.isArray(Ee))for(let Pe=0;Pe<Ee.length;Pe++){let Ae=Ee[Pe];ta(Ae,j,z,Z),Y.add(Ae)}else ta(Ee,j,z,Z),Y.add(Ee)}),M=E.pop(),B!==null&&B.renderEnd(),Y},this.compileAsync=function(T,z,j=null){let Y=this.compile(T,z,j);return new Promise(Z=>{function Ee(){if(Y.forEach(function(Pe){let Ie=Ge.get(Pe).currentProgram;(Ie===void 0||Ie.isReady())&&Y.delete(Pe)}),Y.size===0){Z(T);return}setTimeout(Ee,10)}Ke.get("KHR_parallel_shader_compile")!==null?Ee():setTimeout(Ee,10)})};let qr=null;function Vu(T){qr&&qr(T)}function Al(){bs.stop()}function as(){bs.start()}let bs=new M0;bs.setAnimationLoop(Vu),typeof self<"u"&&bs.setContext(self),this.setAnimationLoop=function(T){qr=T,le.setAnimationLoop(T),T===null?bs.stop():bs.start()},le.addEventListener("sessionstart",Al),le.addEventListener("sessionend",as),this.render=function(T,z){if(z!==void 0&&z.isCamera!==!0){tt("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(L===!0)return;B!==null&&B.renderStart(T,z);let j=le.enabled===!0&&le.isPresenting===!0,Y=k!==null&&(oe===null||j)&&k.begin(N,oe);if(T.matrixWorldAutoUpdate===!0&&T.updateMatrixWorld(),z.parent===null&&z.matrixWorldAutoUpdate===!0&&z.updateMatrixWorld(),le.enabled===!0&&le.isPresenting===!0&&(k===null||k.isCompositing()===!1)&&(le.cameraAutoUpdate===!0&&le.updateCamera(z),z=le.getCamera()),T.isScene===!0&&T.onBeforeRender(N,T,z,oe),M=ee.get(T,E.length),M.init(z),M.state.textureUnits=qe.getTextureUnits(),E.push(M),Dt.multiplyMatrices(z.projectionMatrix,z.matrixWorldInverse),z.isArrayCamera?jt.setFromArrayCamera(z):ot.setFromProjectionMatrix(Dt,Di,z.reversedDepth),pn=this.localClippingEnabled,Gt=ie.init(this.clippingPlanes,pn),R=xe.get(T,_.length),R.init(),_.push(R),this.info.render.frame++,le.enabled===!0&&le.isPresenting===!0){let Pe=N.xr.getDepthSensingMesh();Pe!==null&&Ss(Pe,z,-1/0,N.sortObjects)}Ss(T,z,0,N.sortObjects),R.finish(),B!==null&&B.updateLights(M.state.lightsArray),N.sortObjects===!0&&R.sort(Ve,Je),rn=le.enabled===!1||le.isPresenting===!1||le.hasDepthSensing()===!1,rn&&U.addToRenderList(R,T),this.info.autoReset===!0&&this.info.reset(),Gt===!0&&ie.beginShadows();let Z=M.state.shadowsArray;if(fe.render(Z,T,z),Gt===!0&&ie.endShadows(),(Y&&k.hasRenderPass())===!1){let Pe=R.opaque,Ae=R.transmissive;if(M.setupLights(),z.isArrayCamera){let Ie=z.cameras;if(Ae.length>0)for(let ze=0,nt=Ie.length;ze<nt;ze++){let ft=Ie[ze];Vi(Pe,Ae,T,ft)}rn&&U.render(T);for(let ze=0,nt=Ie.length;ze<nt;ze++){let ft=Ie[ze];na(R,T,ft,ft.viewport)}}else Ae.length>0&&Vi(Pe,Ae,T,z),rn&&U.render(T),na(R,T,z)}oe!==null&&G===0&&(qe.updateMultisampleRenderTarget(oe),qe.updateRenderTargetMipmap(oe)),Y&&k.end(N),T.isScene===!0&&T.onAfterRender(N,T,z),Me.resetDefaultState(),$=-1,J=null,E.pop(),E.length>0?(M=E[E.length-1],qe.setTextureUnits(M.state.textureUnits),Gt===!0&&ie.setGlobalState(N.clippingPlanes,M.state.camera)):M=null,_.pop(),_.length>0?R=_[_.length-1]:R=null,B!==null&&B.renderEnd()};function Ss(T,z,j,Y){if(T.visible===!1)return;if(T.layers.test(z.layers)){if(T.isGroup)j=T.renderOrder;else if(T.isLOD)T.autoUpdate===!0&&T.update(z);else if(T.isLight)M.pushLight(T),T.castShadow&&M.pushShadow(T);else if(T.isSprite){let Pe=z.isArrayCamera?jt:ot;if(!T.frustumCulled||T.intersectsFrustum(Pe)){Y&&bt.setFromMatrixPosition(T.matrixWorld).applyMatrix4(Dt);let Ae=he.update(T),Ie=T.material;Ie.visible&&R.push(T,Ae,Ie,j,bt.z,null,z)}}else if(T.isMesh||T.isLine||T.isPoints){let Pe=z.isArrayCamera?jt:ot;if(!T.frustumCulled||T.intersectsFrustum(Pe)){let Ae=he.update(T),Ie=T.material;if(Y&&(T.boundingSphere!==void 0?(T.boundingSphere===null&&T.computeBoundingSphere(),bt.copy(T.boundingSphere.center)):(Ae.boundingSphere===null&&Ae.computeBoundingSphere(),bt.copy(Ae.boundingSphere.center)),bt.applyMatrix4(T.matrixWorld).applyMatrix4(Dt)),Array.isArray(Ie)){let ze=Ae.groups;for(let nt=0,ft=ze.length;nt<ft;nt++){let Be=ze[nt],pt=Ie[Be.materialIndex];pt&&pt.visible&&R.push(T,Ae,pt,j,bt.z,Be,z)}}else Ie.visible&&R.push(T,Ae,Ie,j,bt.z,null,z)}}}let Ee=T.children;for(let Pe=0,Ae=Ee.length;Pe<Ae;Pe++)Ss(Ee[Pe],z,j,Y)}function na(T,z,j,Y){let{opaque:Z,transmissive:Ee,transparent:Pe}=T;M.setupLightsView(j),Gt===!0&&ie.setGlobalState(N.clippingPlanes,j),Y&&we.viewport(ne.copy(Y)),Z.length>0&&on(Z,z,j),Ee.length>0&&on(Ee,z,j),Pe.length>0&&on(Pe,z,j),we.buffers.depth.setTest(!0),we.buffers.depth.setMask(!0),we.buffers.color.setMask(!0),we.setPolygonOffset(!1)}function Vi(T,z,j,Y){if((j.isScene===!0?j.overrideMaterial:null)!==null)return;if(M.state.transmissionRenderTarget[Y.id]===void 0){let Be=Ke.has("EXT_color_buffer_half_float")||Ke.has("EXT_color_buffer_float");M.state.transmissionRenderTarget[Y.id]=new Si(1,1,{generateMipmaps:!0,type:Be?es:ui,minFilter:ks,samples:Math.max(4,lt.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:vt.workingColorSpace})}let Ee=M.state.transmissionRenderTarget[Y.id],Pe=Y.viewport||ne;Ee.setSize(Pe.z*N.transmissionResolutionScale,Pe.w*N.transmissionResolutionScale);let Ae=N.getRenderTarget(),Ie=N.getActiveCubeFace(),ze=N.getActiveMipmapLevel();N.setRenderTarget(Ee),N.getClearColor(Q),pe=N.getClearAlpha(),pe<1&&N.setClearColor(16777215,.5),N.clear(),rn&&U.render(j);let nt=N.toneMapping;N.toneMapping=Oi;let ft=Y.viewport;if(Y.viewport!==void 0&&(Y.viewport=void 0),M.setupLightsView(Y),Gt===!0&&ie.setGlobalState(N.clippingPlanes,Y),on(T,j,Y),qe.updateMultisampleRenderTarget(Ee),qe.updateRenderTargetMipmap(Ee),Ke.has("WEBGL_multisampled_render_to_texture")===!1){let Be=!1;for(let pt=0,sn=z.length;pt<sn;pt++){let It=z[pt],{object:Lt,geometry:En,material:Fe,group:gn}=It;if(Fe.side===Kn&&Lt.layers.test(Y.layers)){let _t=Fe.side;Fe.side=ai,Fe.needsUpdate=!0,un(Lt,j,Y,En,Fe,gn),Fe.side=_t,Fe.needsUpdate=!0,Be=!0}}Be===!0&&(qe.updateMultisampleRenderTarget(Ee),qe.updateRenderTargetMipmap(Ee))}N.setRenderTarget(Ae,Ie,ze),N.setClearColor(Q,pe),ft!==void 0&&(Y.viewport=ft),N.toneMapping=nt}function on(T,z,j){let Y=z.isScene===!0?z.overrideMaterial:null;for(let Z=0,Ee=T.length;Z<Ee;Z++){let Pe=T[Z],{object:Ae,geometry:Ie,group:ze}=Pe,nt=Pe.material;nt.allowOverride===!0&&Y!==null&&(nt=Y),Ae.layers.test(j.layers)&&un(Ae,z,j,Ie,nt,ze)}}function un(T,z,j,Y,Z,Ee){B!==null&&Z.isNodeMaterial&&B.setObject(T,Z),T.onBeforeRender(N,z,j,Y,Z,Ee),T.modelViewMatrix.multiplyMatrices(j.matrixWorldInverse,T.matrixWorld),T.normalMatrix.getNormalMatrix(T.modelViewMatrix),Z.onBeforeRender(N,z,j,Y,T,Ee),Z.transparent===!0&&Z.side===Kn&&Z.forceSinglePass===!1?(Z.side=ai,Z.needsUpdate=!0,N.renderBufferDirect(j,z,Y,Z,T,Ee),Z.side=ur,Z.needsUpdate=!0,N.renderBufferDirect(j,z,Y,Z,T,Ee),Z.side=Kn):N.renderBufferDirect(j,z,Y,Z,T,Ee),T.onAfterRender(N,z,j,Y,Z,Ee)}function dn(T){let z=0;for(let j of T)j.texture!==null&&z++;return z}function ls(T,z,j){z.isScene!==!0&&(z=Tn);let Y=Ge.get(T),Z=M.state.lights,Ee=M.state.shadowsArray,Pe=Z.state.version,Ae=re.getParameters(T,Z.state,Ee,z,j,M.state.lightProbeGridArray),Ie=re.getProgramCacheKey(Ae),ze=Y.programs;Y.environment=T.isMeshStandardMaterial||T.isMeshLambertMaterial||T.isMeshPhongMaterial?z.environment:null,Y.fog=z.fog;let nt=T.isMeshStandardMaterial||T.isMeshLambertMaterial&&!T.envMap||T.isMeshPhongMaterial&&!T.envMap;Y.envMap=C.get(T.envMap||Y.environment,nt),Y.envMapRotation=Y.environment!==null&&T.envMap===null?z.environmentRotation:T.envMapRotation,ze===void 0&&(T.addEventListener("dispose",ht),ze=new Map,Y.programs=ze,Y.programVariants=new Map);let ft=ze.get(Ie);if(ft!==void 0){if(Y.currentProgram===ft&&Y.lightsStateVersion===Pe)return ia(T,Ae),ft}else Ae.uniforms=re.getUniforms(T),B!==null&&T.isNodeMaterial&&B.build(T,j,Ae),T.onBeforeCompile(Ae,N),ft=re.acquireProgram(Ae,Ie),ze.set(Ie,ft),Y.uniforms=Ae.uniforms;let Be=Y.uniforms;return(!T.isShaderMaterial&&!T.isRawShaderMaterial||T.clipping===!0)&&(Be.clippingPlanes=ie.uniform),ia(T,Ae),Y.needsLights=Xs(T),Y.lightsStateVersion=Pe,Y.needsLights&&(Be.ambientLightColor.value=Z.state.ambient,Be.lightProbe.value=Z.state.probe,Be.sunLights.value=Z.state.sun,Be.sunLightShadows.value=Z.state.sunShadow,Be.directionalLights.value=Z.state.directional,Be.directionalLightShadows.value=Z.state.directionalShadow,Be.spotLights.value=Z.state.spot,Be.spotLightShadows.value=Z.state.spotShadow,Be.rectAreaLights.value=Z.state.rectArea,Be.ltc_1.value=Z.state.rectAreaLTC1,Be.ltc_2.value=Z.state.rectAreaLTC2,Be.pointLights.value=Z.state.point,Be.pointLightShadows.value=Z.state.pointShadow,Be.hemisphereLights.value=Z.state.hemi,Be.sunShadowMatrix.value=Z.state.sunShadowMatrix,Be.sunShadowCascade.value=Z.state.sunShadowCascade,Be.directionalShadowMatrix.value=Z.state.directionalShadowMatrix,Be.spotLightMatrix.value=Z.state.spotLightMatrix,Be.spotLightMap.value=Z.state.spotLightMap,Be.pointShadowMatrix.value=Z.state.pointShadowMatrix),Y.numLightProbeGrids=dn(M.state.lightProbeGridArray),Y.currentProgram=ft,Y.uniformsList=null,ft}function fi(T,z,j,Y,Z){let Ee=Ge.get(T),Pe=Ee.currentProgram.id+","+Y+","+Z,Ae=Ee.programVariants.get(Pe);return Ae===void 0?(Ae=ls(T,z,j),Ee.programVariants.set(Pe,Ae)):(Ee.currentProgram=Ae,Ee.uniformsList=null,Ee.outputColorSpace=Y,Ee.toneMapping=Z),Ae}function Ws(T){if(T.uniformsList===null){let z=T.currentProgram.getUniforms();T.uniformsList=Go.seqWithValue(z.seq,T.uniforms)}return T.uniformsList}function ia(T,z){let j=Ge.get(T);j.outputColorSpace=z.outputColorSpace,j.batching=z.batching,j.batchingColor=z.batchingColor,j.instancing=z.instancing,j.instancingColor=z.instancingColor,j.instancingMorph=z.instancingMorph,j.skinning=z.skinning,j.morphTargets=z.morphTargets,j.morphNormals=z.morphNormals,j.morphColors=z.morphColors,j.morphTargetsCount=z.morphTargetsCount,j.numClippingPlanes=z.numClippingPlanes,j.numIntersection=z.numClipIntersection,j.vertexAlphas=z.vertexAlphas,j.vertexTangents=z.vertexTangents,j.toneMapping=z.toneMapping}function sa(T,z,j,Y,Z){z.isScene!==!0&&(z=Tn),qe.resetTextureUnits();let Ee=z.fog,Pe=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial?z.environment:null,Ae=oe===null?N.outputColorSpace:oe.isXRRenderTarget===!0?oe.texture.colorSpace:vt.workingColorSpace,Ie=Y.isMeshStandardMaterial||Y.isMeshLambertMaterial&&!Y.envMap||Y.isMeshPhongMaterial&&!Y.envMap,ze=C.get(Y.envMap||Pe,Ie),nt=Y.vertexColors===!0&&!!j.attributes.color&&j.attributes.color.itemSize===4,ft=!!j.attributes.tangent&&(!!Y.normalMap||Y.anisotropy>0),Be=!!j.morphAttributes.position,pt=!!j.morphAttributes.normal,sn=!!j.morphAttributes.color,It=Oi;Y.toneMapped&&(oe===null||oe.isXRRenderTarget===!0)&&(It=N.toneMapping);let Lt=j.morphAttributes.position||j.morphAttributes.normal||j.morphAttributes.color,En=Lt!==void 0?Lt.length:0,Fe=Ge.get(Y),gn=M.state.lights;if(Gt===!0&&(pn===!0||T!==J)){let Nt=T===J&&Y.id===$;ie.setState(Y,T,Nt)}let _t=!1,Ms=!1;Y.version===Fe.__version?Fe.needsLights&&Fe.lightsStateVersion!==gn.state.version||Z.isBatchedMesh&&Fe.batching===!1||!Z.isBatchedMesh&&Fe.batching===!0||Z.isBatchedMesh&&Fe.batchingColor===!0&&Z._colorsTexture===null||Z.isBatchedMesh&&Fe.batchingColor===!1&&Z._colorsTexture!==null||Z.isInstancedMesh&&Fe.instancing===!1||!Z.isInstancedMesh&&Fe.instancing===!0||Z.isSkinnedMesh&&Fe.skinning===!1||!Z.isSkinnedMesh&&Fe.skinning===!0||Z.isInstancedMesh&&Fe.instancingColor===!0&&Z.instanceColor===null||Z.isInstancedMesh&&Fe.instancingColor===!1&&Z.instanceColor!==null||Z.isInstancedMesh&&Fe.instancingMorph===!0&&Z.morphTexture===null||Z.isInstancedMesh&&Fe.instancingMorph===!1&&Z.morphTexture!==null||Fe.envMap!==ze||Y.fog===!0&&Fe.fog!==Ee||Fe.numClippingPlanes!==void 0&&(Fe.numClippingPlanes!==ie.numPlanes||Fe.numIntersection!==ie.numIntersection)||Fe.vertexAlphas!==nt||Fe.vertexTangents!==ft||Fe.morphTargets!==Be||Fe.morphNormals!==pt||Fe.morphColors!==sn||Fe.morphTargetsCount!==En||Fe.numLightProbeGrids!==dn(M.state.lightProbeGridArray)?_t=!0:(Fe.outputColorSpace!==Ae||Fe.toneMapping!==It)&&(Ms=!0):(_t=!0,Fe.__version=Y.version);let yn=Fe.currentProgram;(_t===!0||Ms===!0)&&(yn=Ms===!0?fi(Y,z,Z,Ae,It):ls(Y,z,Z),B&&Y.isNodeMaterial&&B.onUpdateProgram(Y,yn,Fe));let Zr=!1,cs=!1,ws=!1,ut=yn.getUniforms(),an=Fe.uniforms;if(we.useProgram(yn.program)&&(Zr=!0,cs=!0,ws=!0),Y.id!==$&&($=Y.id,cs=!0),Zr||J!==T){we.buffers.depth.getReversed()&&T.reversedDepth!==!0&&(T._reversedDepth=!0,T.updateProjectionMatrix()),ut.setValue(O,"projectionMatrix",T.projectionMatrix),ut.setValue(O,"viewMatrix",T.matrixWorldInverse);let _n=ut.map.cameraPosition;_n!==void 0&&_n.setValue(O,Dn.setFromMatrixPosition(T.matrixWorld)),lt.logarithmicDepthBuffer&&ut.setValue(O,"logDepthBufFC",2/(Math.log(T.far+1)/Math.LN2)),(Y.isMeshPhongMaterial||Y.isMeshToonMaterial||Y.isMeshLambertMaterial||Y.isMeshBasicMaterial||Y.isMeshStandardMaterial||Y.isShaderMaterial)&&ut.setValue(O,"isOrthographic",T.isOrthographicCamera===!0),J!==T&&(J=T,cs=!0,ws=!0)}if(Fe.needsLights&&(gn.state.sunShadowMap.length>0&&ut.setValue(O,"sunShadowMap",gn.state.sunShadowMap,qe),gn.state.directionalShadowMap.length>0&&ut.setValue(O,"directionalShadowMap",gn.state.directionalShadowMap,qe),gn.state.spotShadowMap.length>0&&ut.setValue(O,"spotShadowMap",gn.state.spotShadowMap,qe),gn.state.pointShadowMap.length>0&&ut.setValue(O,"pointShadowMap",gn.state.pointShadowMap,qe)),Z.isSkinnedMesh){ut.setOptional(O,Z,"bindMatrix"),ut.setOptional(O,Z,"bindMatrixInverse");let Nt=Z.skeleton;Nt&&(Nt.boneTexture===null&&Nt.computeBoneTexture(),ut.setValue(O,"boneTexture",Nt.boneTexture,qe))}Z.isBatchedMesh&&(ut.setOptional(O,Z,"batchingTexture"),ut.setValue(O,"batchingTexture",Z._matricesTexture,qe),ut.setOptional(O,Z,"batchingIdTexture"),ut.setValue(O,"batchingIdTexture",Z._indirectTexture,qe),ut.setOptional(O,Z,"batchingColorTexture"),Z._colorsTexture!==null&&ut.setValue(O,"batchingColorTexture",Z._colorsTexture,qe));let Qn=j.morphAttributes;if((Qn.position!==void 0||Qn.normal!==void 0||Qn.color!==void 0)&&se.update(Z,j,yn),(cs||Fe.receiveShadow!==Z.receiveShadow)&&(Fe.receiveShadow=Z.receiveShadow,ut.setValue(O,"receiveShadow",Z.receiveShadow)),(Y.isMeshStandardMaterial||Y.isMeshLambertMaterial||Y.isMeshPhongMaterial)&&Y.envMap===null&&z.environment!==null&&(an.envMapIntensity.value=z.environmentIntensity),an.dfgLUT!==void 0&&(an.dfgLUT.value=E1()),cs){if(ut.setValue(O,"toneMappingExposure",N.toneMappingExposure),Fe.needsLights&&$r(an,ws),Ee&&Y.fog===!0&&ve.refreshFogUniforms(an,Ee),ve.refreshMaterialUniforms(an,Y,ge,ye,M.state.transmissionRenderTarget[T.id]),Fe.needsLights&&Fe.numLightProbeGrids>0){let Nt=S,_n=0;for(let qn of M.state.lightProbeGridArray)qn.texture!==null&&(Nt.textures[_n]=qn.texture,Nt.min[_n]=qn.boundingBox.min,Nt.max[_n]=qn.boundingBox.max,Nt.resolution[_n]=qn.resolution,_n++);for(let qn in Nt)Nt[qn].length=_n;an.probesSH.value=Nt.textures,an.probesMin.value=Nt.min,an.probesMax.value=Nt.max,an.probesResolution.value=Nt.resolution}Go.upload(O,Ws(Fe),an,qe)}if(Y.isShaderMaterial&&Y.uniformsNeedUpdate===!0&&(Go.upload(O,Ws(Fe),an,qe),Y.uniformsNeedUpdate=!1),Y.isSpriteMaterial&&ut.setValue(O,"center",Z.center),ut.setValue(O,"modelViewMatrix",Z.modelViewMatrix),ut.setValue(O,"normalMatrix",Z.normalMatrix),ut.setValue(O,"modelMatrix",Z.matrixWorld),Y.uniformsGroups!==void 0){let Nt=Y.uniformsGroups;for(let _n=0,qn=Nt.length;_n<qn;_n++){let Rl=Nt[_n];He.update(Rl,yn),He.bind(Rl,yn)}}return yn}function $r(T,z){T.ambientLightColor.needsUpdate=z,T.lightProbe.needsUpdate=z,T.sunLights.needsUpdate=z,T.sunLightShadows.needsUpdate=z,T.directionalLights.needsUpdate=z,T.directionalLightShadows.needsUpdate=z,T.pointLights.needsUpdate=z,T.pointLightShadows.needsUpdate=z,T.spotLights.needsUpdate=z,T.spotLightShadows.needsUpdate=z,T.rectAreaLights.needsUpdate=z,T.hemisphereLights.needsUpdate=z}function Xs(T){return T.isMeshLambertMaterial||T.isMeshToonMaterial||T.isMeshPhongMaterial||T.isMeshStandardMaterial||T.isShadowMaterial||T.isShaderMaterial&&T.lights===!0}this.getActiveCubeFace=function(){return X},this.getActiveMipmapLevel=function(){return G},this.getRenderTarget=function(){return oe},this.setRenderTargetTextures=function(T,z,j){let Y=Ge.get(T);Y.__autoAllocateDepthBuffer=T.resolveDepthBuffer===!1,Y.__autoAllocateDepthBuffer===!1&&(Y.__useRenderToTexture=!1),Ge.get(T.texture).__webglTexture=z,Ge.get(T.depthTexture).__webglTexture=Y.__autoAllocateDepthBuffer?void 0:j,Y.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(T,z){let j=Ge.get(T);j.__webglFramebuffer=z,j.__useDefaultFramebuffer=z===void 0},this.setRenderTarget=function(T,z=0,j=0){oe=T,X=z,G=j;let Y=null,Z=!1,Ee=!1;if(T){let Ae=Ge.get(T);if(Ae.__useDefaultFramebuffer!==void 0){we.bindFramebuffer(O.FRAMEBUFFER,Ae.__webglFramebuffer),ne.copy(T.viewport),ue.copy(T.scissor),ce=T.scissorTest,we.viewport(ne),we.scissor(ue),we.setScissorTest(ce),$=-1;return}else if(Ae.__webglFramebuffer===void 0)qe.setupRenderTarget(T);else if(Ae.__hasExternalTextures)qe.rebindTextures(T,Ge.get(T.texture).__webglTexture,Ge.get(T.depthTexture).__webglTexture);else if(T.depthBuffer){let nt=T.depthTexture;if(Ae.__boundDepthTexture!==nt){if(nt!==null&&Ge.has(nt)&&(T.width!==nt.image.width||T.height!==nt.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");qe.setupDepthRenderbuffer(T)}}let Ie=T.texture;(Ie.isData3DTexture||Ie.isDataArrayTexture||Ie.isCompressedArrayTexture)&&(Ee=!0);let ze=Ge.get(T).__webglFramebuffer;T.isWebGLCubeRenderTarget?(Array.isArray(ze[z])?Y=ze[z][j]:Y=ze[z],Z=!0):T.samples>0&&qe.useMultisampledRTT(T)===!1?Y=Ge.get(T).__webglMultisampledFramebuffer:Array.isArray(ze)?Y=ze[j]:Y=ze,ne.copy(T.viewport),ue.copy(T.scissor),ce=T.scissorTest}else ne.copy(Ue).multiplyScalar(ge).floor(),ue.copy(rt).multiplyScalar(ge).floor(),ce=ct;if(j!==0&&(Y=V),we.bindFramebuffer(O.FRAMEBUFFER,Y)&&we.drawBuffers(T,Y),we.viewport(ne),we.scissor(ue),we.setScissorTest(ce),Z){let Ae=Ge.get(T.texture);O.framebufferTexture2D(O.FRAMEBUFFER,O.COLOR_ATTACHMENT0,O.TEXTURE_CUBE_MAP_POSITIVE_X+z,Ae.__webglTexture,j)}else if(Ee){let Ae=z;for(let Ie=0;Ie<T.textures.length;Ie++){let ze=Ge.get(T.textures[Ie]);O.framebufferTextureLayer(O.FRAMEBUFFER,O.COLOR_ATTACHMENT0+Ie,ze.__webglTexture,j,Ae)}}else if(T!==null&&j!==0){let Ae=Ge.get(T.texture);O.framebufferTexture2D(O.FRAMEBUFFER,O.COLOR_ATTACHMENT0,O.TEXTURE_2D,Ae.__webglTexture,j)}$=-1};function Yr(T){let z=Ge.get(T);return(z.__readFormat!==T.format||z.__readType!==T.type)&&(z.__readFormat=T.format,z.__readType=T.type,z.__formatReadable=lt.textureFormatReadable(T.format),z.__typeReadable=lt.textureTypeReadable(T.type)),z}this.readRenderTargetPixels=function(T,z,j,Y,Z,Ee,Pe,Ae=0){if(!(T&&T.isWebGLRenderTarget)){tt("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Ie=Ge.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Pe!==void 0&&(Ie=Ie[Pe],Array.isArray(Ie)&&(Ie=Ie[0])),Ie){we.bindFramebuffer(O.FRAMEBUFFER,Ie);try{let ze=T.textures[Ae],nt=ze.format,ft=ze.type;T.textures.length>1&&O.readBuffer(O.COLOR_ATTACHMENT0+Ae);let Be=Yr(ze);if(Be.__formatReadable===!1){tt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Be.__typeReadable===!1){tt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}z>=0&&z<=T.width-Y&&j>=0&&j<=T.height-Z&&O.readPixels(z,j,Y,Z,_e.convert(nt),_e.convert(ft),Ee)}finally{let ze=oe!==null?Ge.get(oe).__webglFramebuffer:null;we.bindFramebuffer(O.FRAMEBUFFER,ze)}}},this.readRenderTargetPixelsAsync=async function(T,z,j,Y,Z,Ee,Pe,Ae=0){if(!(T&&T.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Ie=Ge.get(T).__webglFramebuffer;if(T.isWebGLCubeRenderTarget&&Pe!==void 0&&(Ie=Ie[Pe],Array.isArray(Ie)&&(Ie=Ie[0])),Ie)if(z>=0&&z<=T.width-Y&&j>=0&&j<=T.height-Z){we.bindFramebuffer(O.FRAMEBUFFER,Ie);let ze=T.textures[Ae],nt=ze.format,ft=ze.type;T.textures.length>1&&O.readBuffer(O.COLOR_ATTACHMENT0+Ae);let Be=Yr(ze);if(Be.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Be.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let pt=O.createBuffer();O.bindBuffer(O.PIXEL_PACK_BUFFER,pt),O.bufferData(O.PIXEL_PACK_BUFFER,Ee.byteLength,O.STREAM_READ),O.readPixels(z,j,Y,Z,_e.convert(nt),_e.convert(ft),0),O.bindBuffer(O.PIXEL_PACK_BUFFER,null);let sn=oe!==null?Ge.get(oe).__webglFramebuffer:null;we.bindFramebuffer(O.FRAMEBUFFER,sn);let It=O.fenceSync(O.SYNC_GPU_COMMANDS_COMPLETE,0);return O.flush(),await Yg(O,It,4),O.bindBuffer(O.PIXEL_PACK_BUFFER,pt),O.getBufferSubData(O.PIXEL_PACK_BUFFER,0,Ee),O.bindBuffer(O.PIXEL_PACK_BUFFER,null),O.deleteBuffer(pt),O.deleteSync(It),Ee}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(T,z=null,j=0){let Y=Math.pow(2,-j),Z=Math.floor(T.image.width*Y),Ee=Math.floor(T.image.height*Y),Pe=z!==null?z.x:0,Ae=z!==null?z.y:0;qe.setTexture2D(T,0),O.copyTexSubImage2D(O.TEXTURE_2D,j,0,0,Pe,Ae,Z,Ee),we.unbindTexture()},this.copyTextureToTexture=function(T,z,j=null,Y=null,Z=0,Ee=0){let Pe,Ae,Ie,ze,nt,ft,Be,pt,sn,It=T.isCompressedTexture?T.mipmaps[Ee]:T.image;if(j!==null)Pe=j.max.x-j.min.x,Ae=j.max.y-j.min.y,Ie=j.isBox3?j.max.z-j.min.z:1,ze=j.min.x,nt=j.min.y,ft=j.isBox3?j.min.z:0;else{let ut=Math.pow(2,-Z);Pe=Math.floor(It.width*ut),Ae=Math.floor(It.height*ut),T.isDataArrayTexture?Ie=It.depth:T.isData3DTexture?Ie=Math.floor(It.depth*ut):Ie=1,ze=0,nt=0,ft=0}Y!==null?(Be=Y.x,pt=Y.y,sn=Y.z):(Be=0,pt=0,sn=0);let Lt=_e.convert(z.format),En=_e.convert(z.type),Fe;z.isData3DTexture?(qe.setTexture3D(z,0),Fe=O.TEXTURE_3D):z.isDataArrayTexture||z.isCompressedArrayTexture?(qe.setTexture2DArray(z,0),Fe=O.TEXTURE_2D_ARRAY):(qe.setTexture2D(z,0),Fe=O.TEXTURE_2D),we.activeTexture(O.TEXTURE0),we.pixelStorei(O.UNPACK_FLIP_Y_WEBGL,z.flipY),we.pixelStorei(O.UNPACK_PREMULTIPLY_ALPHA_WEBGL,z.premultiplyAlpha),we.pixelStorei(O.UNPACK_ALIGNMENT,z.unpackAlignment);let gn=we.getParameter(O.UNPACK_ROW_LENGTH),_t=we.getParameter(O.UNPACK_IMAGE_HEIGHT),Ms=we.getParameter(O.UNPACK_SKIP_PIXELS),yn=we.getParameter(O.UNPACK_SKIP_ROWS),Zr=we.getParameter(O.UNPACK_SKIP_IMAGES);we.pixelStorei(O.UNPACK_ROW_LENGTH,It.width),we.pixelStorei(O.UNPACK_IMAGE_HEIGHT,It.height),we.pixelStorei(O.UNPACK_SKIP_PIXELS,ze),we.pixelStorei(O.UNPACK_SKIP_ROWS,nt),we.pixelStorei(O.UNPACK_SKIP_IMAGES,ft);let cs=T.isDataArrayTexture||T.isData3DTexture,ws=z.isDataArrayTexture||z.isData3DTexture;if(T.isDepthTexture){let ut=Ge.get(T),an=Ge.get(z),Qn=Ge.get(ut.__renderTarget),Nt=Ge.get(an.__renderTarget);we.bindFramebuffer(O.READ_FRAMEBUFFER,Qn.__webglFramebuffer),we.bindFramebuffer(O.DRAW_FRAMEBUFFER,Nt.__webglFramebuffer);for(let _n=0;_n<Ie;_n++)cs&&(O.framebufferTextureLayer(O.READ_FRAMEBUFFER,O.COLOR_ATTACHMENT0,Ge.get(T).__webglTexture,Z,ft+_n),O.framebufferTextureLayer(O.DRAW_FRAMEBUFFER,O.COLOR_ATTACHMENT0,Ge.get(z).__webglTexture,Ee,sn+_n)),O.blitFramebuffer(ze,nt,ze+Pe,nt+Ae,Be,pt,Be+Pe,pt+Ae,O.DEPTH_BUFFER_BIT,O.NEAREST);we.bindFramebuffer(O.READ_FRAMEBUFFER,null),we.bindFramebuffer(O.DRAW_FRAMEBUFFER,null)}else if(Z!==0||T.isRenderTargetTexture||Ge.has(T)){let ut=Ge.get(T),an=Ge.get(z);we.bindFramebuffer(O.READ_FRAMEBUFFER,P),we.bindFramebuffer(O.DRAW_FRAMEBUFFER,F);for(let Qn=0;Qn<Ie;Qn++)cs?O.framebufferTextureLayer(O.READ_FRAMEBUFFER,O.COLOR_ATTACHMENT0,ut.__webglTexture,Z,ft+Qn):O.framebufferTexture2D(O.READ_FRAMEBUFFER,O.COLOR_ATTACHMENT0,O.TEXTURE_2D,ut.__webglTexture,Z),ws?O.framebufferTextureLayer(O.DRAW_FRAMEBUFFER,O.COLOR_ATTACHMENT0,an.__webglTexture,Ee,sn+Qn):O.framebufferTexture2D(O.DRAW_FRAMEBUFFER,O.COLOR_ATTACHMENT0,O.TEXTURE_2D,an.__webglTexture,Ee),Z!==0?O.blitFramebuffer(ze,nt,ze+Pe,nt+Ae,Be,pt,Be+Pe,pt+Ae,O.COLOR_BUFFER_BIT,O.NEAREST):ws?O.copyTexSubImage3D(Fe,Ee,Be,pt,sn+Qn,ze,nt,Pe,Ae):O.copyTexSubImage2D(Fe,Ee,Be,pt,ze,nt,Pe,Ae);we.bindFramebuffer(O.READ_FRAMEBUFFER,null),we.bindFramebuffer(O.DRAW_FRAMEBUFFER,null)}else ws?T.isDataTexture||T.isData3DTexture?O.texSubImage3D(Fe,Ee,Be,pt,sn,Pe,Ae,Ie,Lt,En,It.data):z.isCompressedArrayTexture?O.compressedTexSubImage3D(Fe,Ee,Be,pt,sn,Pe,Ae,Ie,Lt,It.data):O.texSubImage3D(Fe,Ee,Be,pt,sn,Pe,Ae,Ie,Lt,En,It):T.isDataTexture?O.texSubImage2D(O.TEXTURE_2D,Ee,Be,pt,Pe,Ae,Lt,En,It.data):T.isCompressedTexture?O.compressedTexSubImage2D(O.TEXTURE_2D,Ee,Be,pt,It.width,It.height,Lt,It.data):O.texSubImage2D(O.TEXTURE_2D,Ee,Be,pt,Pe,Ae,Lt,En,It);we.pixelStorei(O.UNPACK_ROW_LENGTH,gn),we.pixelStorei(O.UNPACK_IMAGE_HEIGHT,_t),we.pixelStorei(O.UNPACK_SKIP_PIXELS,Ms),we.pixelStorei(O.UNPACK_SKIP_ROWS,yn),we.pixelStorei(O.UNPACK_SKIP_IMAGES,Zr),Ee===0&&z.generateMipmaps===!0&&z.mipmapsAutoUpdate===!0&&O.generateMipmap(Fe),we.unbindTexture()},this.initRenderTarget=function(T){Ge.get(T).__webglFramebuffer===void 0&&qe.setupRenderTarget(T)},this.initTexture=function(T){T.isCubeTexture?qe.setTextureCube(T,0):T.isData3DTexture?qe.setTexture3D(T,0):T.isDataArrayTexture||T.isCompressedArrayTexture?qe.setTexture2DArray(T,0):qe.setTexture2D(T,0),we.unbindTexture()},this.resetState=function(){X=0,G=0,oe=null,we.reset(),Me.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Di}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(e){this._outputColorSpace=e;let t=this.getContext();t.drawingBufferColorSpace=vt._getDrawingBufferColorSpace(e),t.unpackColorSpace=vt._getUnpackColorSpace()}};var D0={type:"change"},Ff={type:"start"},U0={type:"end"},Zh=new Fs,F0=new ii,A1=Math.cos(70*vf.DEG2RAD),In=new W,di=2*Math.PI,Et={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},Df=1e-6,Kh=class extends Ka{constructor(e,t=null){super(e,t),this.state=Et.NONE,this.target=new W,this.cursor=new W,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:Ui.ROTATE,MIDDLE:Ui.DOLLY,RIGHT:Ui.PAN},this.touches={ONE:ji.ROTATE,TWO:ji.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new W,this._lastQuaternion=new oi,this._lastTargetPosition=new W,this._quat=new oi().setFromUnitVectors(e.up,new W(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new Uo,this._sphericalDelta=new Uo,this._scale=1,this._panOffset=new W,this._rotateStart=new Ze,this._rotateEnd=new Ze,this._rotateDelta=new Ze,this._panStart=new Ze,this._panEnd=new Ze,this._panDelta=new Ze,this._dollyStart=new Ze,this._dollyEnd=new Ze,this._dollyDelta=new Ze,this._dollyDirection=new W,this._mouse=new Ze,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=C1.bind(this),this._onPointerDown=R1.bind(this),this._onPointerUp=P1.bind(this),this._onContextMenu=O1.bind(this),this._onMouseWheel=N1.bind(this),this._onKeyDown=D1.bind(this),this._onTouchStart=F1.bind(this),this._onTouchMove=U1.bind(this),this._onMouseDown=I1.bind(this),this._onMouseMove=L1.bind(this),this._interceptControlDown=k1.bind(this),this._interceptControlUp=B1.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(e){this._cursorStyle=e,e==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(e){super.connect(e),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=Et.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(e){e.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=e}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(D0),this.update(),this.state=Et.NONE}pan(e,t){this._pan(e,t),this.update()}dollyIn(e){this._dollyIn(e),this.update()}dollyOut(e){this._dollyOut(e),this.update()}rotateLeft(e){this._rotateLeft(e),this.update()}rotateUp(e){this._rotateUp(e),this.update()}update(e=null){let t=this.object.position;In.copy(t).sub(this.target),In.applyQuaternion(this._quat),this._spherical.setFromVector3(In),this.autoRotate&&this.state===Et.NONE&&this._rotateLeft(this._getAutoRotationAngle(e)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=di:n>Math.PI&&(n-=di),s<-Math.PI?s+=di:s>Math.PI&&(s-=di),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(In.setFromSpherical(this._spherical),In.applyQuaternion(this._quatInverse),t.copy(this.target).add(In),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=In.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new W(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new W(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=In.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(Zh.origin.copy(this.object.position),Zh.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(Zh.direction))<A1?this.object.lookAt(this.target):(F0.setFromNormalAndCoplanarPoint(this.object.up,this.target),Zh.intersectPlane(F0,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>Df||8*(1-this._lastQuaternion.dot(this.object.quaternion))>Df||this._lastTargetPosition.distanceToSquared(this.target)>Df?(this.dispatchEvent(D0),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(e){return e!==null?di/60*this.autoRotateSpeed*e:di/60/60*this.autoRotateSpeed}_getZoomScale(e){let t=Math.abs(e*.01);return Math.pow(.95,this.zoomSpeed*t)}_rotateLeft(e){this._sphericalDelta.theta-=e}_rotateUp(e){this._sphericalDelta.phi-=e}_panLeft(e,t){In.setFromMatrixColumn(t,0),In.multiplyScalar(-e),this._panOffset.add(In)}_panUp(e,t){this.screenSpacePanning===!0?In.setFromMatrixColumn(t,1):(In.setFromMatrixColumn(t,0),In.crossVectors(this.object.up,In)),In.multiplyScalar(e),this._panOffset.add(In)}_pan(e,t){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;In.copy(s).sub(this.target);let r=In.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*e*r/n.clientHeight,this.object.matrix),this._panUp(2*t*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(e*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(t*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(e){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=e:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(e){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=e:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(e,t){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=e-n.left,r=t-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(e){return Math.max(this.minDistance,Math.min(this.maxDistance,e))}_handleMouseDownRotate(e){this._rotateStart.set(e.clientX,e.clientY)}_handleMouseDownDolly(e){this._updateZoomParameters(e.clientX,e.clientY),this._dollyStart.set(e.clientX,e.clientY)}_handleMouseDownPan(e){this._panStart.set(e.clientX,e.clientY)}_handleMouseMoveRotate(e){this._rotateEnd.set(e.clientX,e.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let t=this.domElement;this._rotateLeft(di*this._rotateDelta.x/t.clientHeight),this._rotateUp(di*this._rotateDelta.y/t.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(e){this._dollyEnd.set(e.clientX,e.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(e){this._panEnd.set(e.clientX,e.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(e){this._updateZoomParameters(e.clientX,e.clientY),e.deltaY<0?this._dollyIn(this._getZoomScale(e.deltaY)):e.deltaY>0&&this._dollyOut(this._getZoomScale(e.deltaY)),this.update()}_handleKeyDown(e){let t=!1;switch(e.code){case this.keys.UP:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateUp(di*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),t=!0;break;case this.keys.BOTTOM:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateUp(-di*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),t=!0;break;case this.keys.LEFT:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateLeft(di*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),t=!0;break;case this.keys.RIGHT:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateLeft(-di*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),t=!0;break}t&&(e.preventDefault(),this.update())}_handleTouchStartRotate(e){if(this._pointers.length===1)this._rotateStart.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(e){if(this._pointers.length===1)this._panStart.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._panStart.set(n,s)}}_handleTouchStartDolly(e){let t=this._getSecondPointerPosition(e),n=e.pageX-t.x,s=e.pageY-t.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(e){this.enableZoom&&this._handleTouchStartDolly(e),this.enablePan&&this._handleTouchStartPan(e)}_handleTouchStartDollyRotate(e){this.enableZoom&&this._handleTouchStartDolly(e),this.enableRotate&&this._handleTouchStartRotate(e)}_handleTouchMoveRotate(e){if(this._pointers.length==1)this._rotateEnd.set(e.pageX,e.pageY);else{let n=this._getSecondPointerPosition(e),s=.5*(e.pageX+n.x),r=.5*(e.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let t=this.domElement;this._rotateLeft(di*this._rotateDelta.x/t.clientHeight),this._rotateUp(di*this._rotateDelta.y/t.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(e){if(this._pointers.length===1)this._panEnd.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(e){let t=this._getSecondPointerPosition(e),n=e.pageX-t.x,s=e.pageY-t.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(e.pageX+t.x)*.5,a=(e.pageY+t.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(e){this.enableZoom&&this._handleTouchMoveDolly(e),this.enablePan&&this._handleTouchMovePan(e)}_handleTouchMoveDollyRotate(e){this.enableZoom&&this._handleTouchMoveDolly(e),this.enableRotate&&this._handleTouchMoveRotate(e)}_addPointer(e){this._pointers.push(e.pointerId)}_removePointer(e){delete this._pointerPositions[e.pointerId];for(let t=0;t<this._pointers.length;t++)if(this._pointers[t]==e.pointerId){this._pointers.splice(t,1);return}}_isTrackingPointer(e){for(let t=0;t<this._pointers.length;t++)if(this._pointers[t]==e.pointerId)return!0;return!1}_trackPointer(e){let t=this._pointerPositions[e.pointerId];t===void 0&&(t=new Ze,this._pointerPositions[e.pointerId]=t),t.set(e.pageX,e.pageY)}_getSecondPointerPosition(e){let t=e.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[t]}_customWheelEvent(e){let t=e.deltaMode,n={clientX:e.clientX,clientY:e.clientY,deltaY:e.deltaY};switch(t){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return e.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function R1(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function C1(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function P1(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(U0),this.state=Et.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let e=this._pointers[0],t=this._pointerPositions[e];this._onTouchStart({pointerId:e,pageX:t.x,pageY:t.y});break}}function I1(i){let e;switch(i.button){case 0:e=this.mouseButtons.LEFT;break;case 1:e=this.mouseButtons.MIDDLE;break;case 2:e=this.mouseButtons.RIGHT;break;default:e=-1}switch(e){case Ui.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=Et.DOLLY;break;case Ui.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Et.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Et.ROTATE}break;case Ui.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=Et.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=Et.PAN}break;default:this.state=Et.NONE}this.state!==Et.NONE&&this.dispatchEvent(Ff)}function L1(i){switch(this.state){case Et.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case Et.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case Et.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function N1(i){this.enabled===!1||this.enableZoom===!1||this.state!==Et.NONE||(i.preventDefault(),this.dispatchEvent(Ff),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(U0))}function D1(i){this.enabled!==!1&&this._handleKeyDown(i)}function F1(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case ji.ROTATE:if(this.enableRotate===!1){this.state=Et.NONE;break}this._handleTouchStartRotate(i),this.state=Et.TOUCH_ROTATE;break;case ji.PAN:if(this.enablePan===!1){this.state=Et.NONE;break}this._handleTouchStartPan(i),this.state=Et.TOUCH_PAN;break;default:this.state=Et.NONE}break;case 2:switch(this.touches.TWO){case ji.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=Et.TOUCH_DOLLY_PAN;break;case ji.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=Et.TOUCH_DOLLY_ROTATE;break;default:this.state=Et.NONE}break;default:this.state=Et.NONE}this.state!==Et.NONE&&this.dispatchEvent(Ff)}function U1(i){switch(this._trackPointer(i),this.state){case Et.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case Et.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case Et.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case Et.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=Et.NONE}}function O1(i){this.enabled!==!1&&i.preventDefault()}function k1(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function B1(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var z1=[[1e6,"M"],[1e3,"k"],[1,""],[.001,"m"],[1e-6,"µ"],[1e-9,"n"]];function ns(i,e){if(!Number.isFinite(i))return`– ${e}`;let t=Math.abs(i);if(t===0)return`0 ${e}`;let[n,s]=z1.find(([r])=>t>=r*.9995)??[1e-9,"n"];return`${Vs(i/n,3)} ${s}${e}`}function Vs(i,e){if(!Number.isFinite(i))return"–";let t=Math.abs(i),n=t>=1?Math.floor(Math.log10(t)+1e-12)+1:1;return i.toFixed(Math.max(0,e-n)).replace(/^-(0(?:\.0+)?)$/,"$1")}var kr=i=>`${i.toFixed(2).replace(/^-(0\.00)$/,"$1")} N`;function fr(i,e=2){if(!Number.isFinite(i))return"–";let t=Math.floor(Math.abs(i)),[n,s,r]=[Math.floor(t/3600),Math.floor(t/60)%60,t%60],o=Math.floor((Math.abs(i)-t)*10**e+1e-6),a=e>0?`.${String(Math.min(o,10**e-1)).padStart(e,"0")}`:"",l=c=>String(c).padStart(2,"0");return(n>0?`${n}:${l(s)}`:`${s}`)+`:${l(r)}${a}`}function pr(i){if(!(i>0)||!Number.isFinite(i))return 1;let e=10**Math.floor(Math.log10(i));return e*([1,2,5,10].find(t=>t*e>=i*(1-1e-9))??10)}function Jh(i){return i<1e3?`${i} B`:i<1e6?`${(i/1e3).toFixed(0)} kB`:i<1e9?`${(i/1e6).toFixed(1)} MB`:`${(i/1e9).toFixed(2)} GB`}var V1=/swiftshader|llvmpipe|softpipe|basic render|software/i;function O0(){let i=document.createElement("canvas").getContext("webgl2",{antialias:!1,depth:!1});if(i===null)return!1;let e=i.getExtension("WEBGL_debug_renderer_info"),t=i.getParameter(e?.UNMASKED_RENDERER_WEBGL??i.RENDERER);return i.getExtension("WEBGL_lose_context")?.loseContext(),typeof t=="string"&&V1.test(t)}var k0=28,B0=.55,G1=180,H1=`
varying vec2 place;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  place = world.xy;
  gl_Position = projectionMatrix * viewMatrix * world;
}`,W1=`
varying vec2 place;
uniform vec3 colour;
uniform vec2 middle;
uniform float cell, reach;
float lines(float size) {
  vec2 at = place / size;
  vec2 near = abs(fract(at - 0.5) - 0.5) / max(fwidth(at), vec2(1e-6));
  return 1.0 - min(min(near.x, near.y), 1.0);
}
void main() {
  float fade = 1.0 - smoothstep(0.25 * reach, reach, length(place - middle));
  float alpha = max(0.22 * lines(cell), 0.5 * lines(10.0 * cell)) * fade;
  if (alpha < 0.004) discard;
  gl_FragColor = vec4(colour, alpha);
}`,jh=class{constructor(e){this.canvas=e;let t=O0();this.thrifty=this.coarse=t,this.renderer=new qh({canvas:e,antialias:!t,alpha:!0,powerPreference:"high-performance"}),this.renderer.toneMapping=Oi,this.renderer.localClippingEnabled=!0,this.renderer.shadowMap.type=Lr,this.camera.up.set(0,0,1),this.controls=new Kh(this.camera,e),this.controls.enableDamping=!0,this.controls.dampingFactor=.12,this.controls.zoomToCursor=!0,this.controls.mouseButtons={LEFT:Ui.ROTATE,MIDDLE:Ui.PAN,RIGHT:Ui.PAN},this.controls.touches={ONE:ji.ROTATE,TWO:ji.DOLLY_PAN},this.controls.addEventListener("change",()=>this.ask()),this.controls.addEventListener("start",()=>this.goal=null);let n=new Pr(1,1);this.grid=new Zt(n,new Fi({vertexShader:H1,fragmentShader:W1,transparent:!0,depthWrite:!1,side:Kn,uniforms:{colour:{value:new it},middle:{value:new Ze},cell:{value:.01},reach:{value:1}}})),this.grid.renderOrder=-1,this.shade=new Zt(n,new Ha({opacity:.28,depthWrite:!1})),this.shade.receiveShadow=!0,this.shade.renderOrder=-2,this.sun.shadow.mapSize.set(1024,1024),this.sun.shadow.radius=4,this.scene.add(this.content,this.grid,this.shade,this.sky,this.sun,this.sun.target,this.camera,new Ya(16777215,.12)),this.camera.add(this.head),this.head.position.set(-.4,.5,1),this.setShadows(!0)}canvas;scene=new Na;camera=new si(38,1,.001,100);renderer;controls;content=new hn;clip=new ii(new W(1,0,0),0);cell=.01;size=.1;cost=0;thrifty=!1;coarse=!1;mayBeCoarse=!0;onCamera=()=>{};sun=new Do(16775922,2.3);head=new Do(16777215,.7);sky=new Xa(16514303,8818080,1.1);grid;shade;wanted=!0;slow=0;lastDrawn=0;extent=[1,1];buffer="";ratio=1;shadows=!0;inset=0;goal=null;ask(){this.wanted=!0}setPalette({grid:e,light:t}){this.grid.material.uniforms.colour.value.set(e),this.shade.material.opacity=t?.2:.42,this.sky.intensity=t?1.3:1,this.ask()}setShadows(e){this.shadows=e;let t=e&&!this.thrifty;this.sun.castShadow!==t&&(this.sun.castShadow=t,this.renderer.shadowMap.enabled=t,this.renderer.shadowMap.needsUpdate=!0,this.scene.traverse(n=>{n instanceof Zt&&!Array.isArray(n.material)&&(n.material.needsUpdate=!0)})),this.shade.visible=t&&this.grid.visible,this.ask()}setGrid(e){this.grid.visible=e,this.shade.visible=e&&this.sun.castShadow,this.ask()}setScene(e,t,n){this.size=t,this.cell=pr(t/12);let s=2.6*t,{uniforms:r}=this.grid.material;r.cell.value=this.cell,r.reach.value=s,r.middle.value.set(e[0],e[1]);for(let a of[this.grid,this.shade])a.scale.setScalar(2*s),a.position.set(e[0],e[1],n);this.shade.position.z-=1e-4*t,this.sun.position.set(e[0]+.6*t,e[1]-.8*t,e[2]+2*t),this.sun.target.position.set(...e);let o=this.sun.shadow;Object.assign(o.camera,{left:-t,right:t,top:t,bottom:-t,near:.1*t,far:5*t}),o.camera.updateProjectionMatrix(),o.bias=-2e-4,o.normalBias=.01*t,this.camera.near=t/200,this.camera.far=t*40,this.camera.updateProjectionMatrix(),this.controls.minDistance=.15*t,this.controls.maxDistance=12*t,this.ask()}fit(e,t,n,s=!0){let r=new W(...e),o=n===null?this.camera.position.clone().sub(this.controls.target):new W(...n);o.lengthSq()===0&&o.set(1,-1,.6);let a=this.camera.fov*Math.PI/360,{clientWidth:l,clientHeight:c}=this.canvas,h=Math.min(1,(l-this.inset)/Math.max(c,1)),d=.5*t/Math.tan(a)/h+.12*t,u=r.clone().add(o.setLength(d));s&&!matchMedia("(prefers-reduced-motion: reduce)").matches?this.goal={target:r,position:u}:(this.goal=null,this.controls.target.copy(r),this.camera.position.copy(u),this.controls.update()),this.ask()}orbit(e,t){this.goal=null;let n=this.camera.position.clone().sub(this.controls.target),s=n.length(),r=Math.min(Math.max(Math.asin(n.z/s)+t,-1.5),1.5),o=Math.atan2(n.y,n.x)-e;n.set(Math.cos(r)*Math.cos(o),Math.cos(r)*Math.sin(o),Math.sin(r)).multiplyScalar(s),this.camera.position.copy(this.controls.target).add(n),this.ask()}zoom(e){let t=this.camera.position.clone().sub(this.controls.target),n=Math.min(Math.max(t.length()*e,this.controls.minDistance),this.controls.maxDistance);this.camera.position.copy(this.controls.target).add(t.setLength(n)),this.ask()}resize(e,t,n){e<1||t<1||(this.extent=[e,t],this.inset=n,this.sharpness(this.coarse&&this.mayBeCoarse?B0:this.fine()),this.camera.aspect=e/t,this.inset>0?this.camera.setViewOffset(e,t,-this.inset/2,0,e,t):this.camera.clearViewOffset(),this.camera.updateProjectionMatrix(),this.ask())}sharpness(e){let[t,n]=this.extent,s=[t,n,e].join();s!==this.buffer&&(this.buffer=s,this.ratio=e,this.renderer.setDrawingBufferSize(t,n,e))}fine(){return this.thrifty?1:Math.min(devicePixelRatio,2)}project(e){let t=new W(...e),n=-t.clone().applyMatrix4(this.camera.matrixWorldInverse).z;if(t.project(this.camera),n<=this.camera.near||!Number.isFinite(t.x))return null;let{clientWidth:s,clientHeight:r}=this.canvas,o=2*n*Math.tan(this.camera.fov*Math.PI/360);return{x:(t.x/2+.5)*s,y:(.5-t.y/2)*r,metresPerPixel:o/r}}axes(){let e=this.camera.matrixWorld.elements;return{right:[e[0],e[1],e[2]],up:[e[4],e[5],e[6]],away:[-e[8],-e[9],-e[10]]}}draw(){if(this.goal!==null){let{target:s,position:r}=this.goal;this.controls.target.lerp(s,.2),this.camera.position.lerp(r,.2),this.camera.position.distanceTo(r)<.001*this.size&&(this.goal=null),this.wanted=!0}if(this.controls.update(),this.renderer.getContext().isContextLost())return!1;let e=performance.now(),t=e-this.lastDrawn>G1,n=this.coarse&&this.mayBeCoarse&&!(t&&!this.wanted)?B0:this.fine();return t&&n>this.ratio&&(this.wanted=!0),this.wanted?(this.sharpness(n),this.wanted=!1,this.lastDrawn=e,this.renderer.render(this.scene,this.camera),this.cost+=.1*(performance.now()-e-this.cost),this.onCamera(),!0):!1}pace(e){this.coarse||e>500&&this.cost<100||(this.slow+=e>(this.thrifty?2*k0:k0)?1:-1,this.slow=Math.max(0,this.slow),!(this.slow<24)&&(this.slow=0,this.coarse=this.thrifty,this.thrifty=!0,this.setShadows(this.shadows)))}async png(e){this.sharpness(this.fine()),this.renderer.render(this.scene,this.camera);let t=document.createElement("canvas");t.width=this.canvas.width,t.height=this.canvas.height;let n=t.getContext("2d");return n===null?null:(n.fillStyle=e,n.fillRect(0,0,t.width,t.height),n.drawImage(this.canvas,0,0),new Promise(s=>t.toBlob(s,"image/png")))}};var V0={ember:["#f1dfd2","#f8cfa6","#f9b277","#f28f4f","#e0693a","#c24333","#962640","#651746","#38103c"],viridis:["#440154","#482878","#3e4989","#31688e","#26828e","#1f9e89","#35b779","#6ece58","#b5de2b","#fde725"],cividis:["#00224e","#123570","#3b496c","#575d6d","#707173","#8a8678","#a59c74","#c3b369","#e1cc55","#fee838"],diverging:["#053061","#2166ac","#4393c3","#92c5de","#f2f2f2","#f4a582","#d6604d","#b2182b","#67001f"]},X1=i=>i<=.04045?i/12.92:((i+.055)/1.055)**2.4;function q1(i){return[1,3,5].map(e=>parseInt(i.slice(e,e+2),16)/255)}var ll=256,z0=new Map;function $1(i){let e=z0.get(i);if(e!==void 0)return e;let t=V0[i].map(q1),n=new Float32Array(3*ll);for(let s=0;s<ll;s++){let r=s/(ll-1)*(t.length-1),o=Math.min(Math.floor(r),t.length-2);for(let a=0;a<3;a++)n[3*s+a]=X1(t[o][a]+(t[o+1][a]-t[o][a])*(r-o))}return z0.set(i,n),n}function G0(i){return`linear-gradient(to right, ${V0[i].join(", ")})`}function hl(i,e,t,n,s){let r=$1(n),o=(ll-1)/(t-e||1);for(let a=0;a<i.length;a++){let l=Math.round(Math.min(Math.max((i[a]-e)*o,0),ll-1))*3;s[3*a]=r[l],s[3*a+1]=r[l+1],s[3*a+2]=r[l+2]}}var cl=class{top=0;since=0;follow(e,t,n,s){if(s&&this.top>0)return this.top;let r=pr(Math.max(e,t));return r>=this.top?[this.top,this.since]=[r,n]:e>.4*this.top?this.since=n:n-this.since>3e3&&([this.top,this.since]=[r,n]),this.top}reset(){this.top=0}};function H0(i){switch(i.colourBy){case"displacement":return{label:"Displacement",unit:"m",map:i.map};case"indentation":return{label:"Indentation (inwards)",unit:"m",map:i.map};case"curvature":return{label:"Mean curvature",unit:"1/m",map:"diverging"};case"stiffness":return{label:"Young's modulus",unit:"Pa",map:i.map};case"difference":return{label:"Difference of the two",unit:"m",map:i.map};default:return null}}var Qh=class{constructor(e,t,n){this.inside=e;this.origin=t;this.at=new Float32Array(e.nodes.length),this.attribute=new Ht(this.at,3);let s=bm(e),r=new Float32Array(this.at.length),o=s.reduce((h,d)=>Math.max(h,d),0),a=s.reduce((h,d)=>Math.min(h,d),o);a<o?hl(s,a,o,"viridis",r):hl(s.fill(.5),0,1,"viridis",r);let l=()=>{let h=new nn;return h.setAttribute("position",this.attribute),h.setAttribute("color",new Ht(r,3)),h.boundingSphere=new Rn(new W,4*n),h},c=l();c.setIndex(new Ht(vm(e),1)),this.parts=[new ys(c,new Mi({vertexColors:!0,transparent:!0,opacity:.6})),new Cr(l(),new ar({vertexColors:!0,size:3,sizeAttenuation:!1}))],this.group.add(...this.parts),this.place(e.nodes,0)}inside;origin;group=new hn;at;attribute;parts;version=-1;place(e,t){if(!(t===this.version||e.length!==this.at.length)){this.version=t;for(let n=0;n<e.length;n++)this.at[n]=e[n]-this.origin[n%3];this.attribute.needsUpdate=!0}}dispose(){for(let e of this.parts)e.geometry.dispose(),e.material.dispose();this.group.removeFromParent()}};var Y1=104,Z1=18,W0=["#f1dfd2","#9fd0f0","#f3c98b","#8fd8bd","#e8b1d1","#f2e791","#a9b8e8"],eu=class{constructor(e,t,n,s,r){this.body=e;this.stage=t;this.number=n;let{middle:o,size:a}=new ci().take(e.rest);this.size=a;let l=Math.max(28,Math.round(Y1/Math.sqrt(s))),c=e.rest.length===3*e.surface.u.count*e.surface.v.count,h=o;Mr(e)?this.tessellation=r===void 0?null:new Sr(r,e.rest,h):this.tessellation=c?ql(e.surface,h,l):null;let d=this.tessellation,u=new Os({vertexColors:!0,side:Kn,specular:2763306,shininess:22,clipShadows:!0,polygonOffset:!0,polygonOffsetFactor:1,polygonOffsetUnits:1});this.surface=new Zt(this.geometry,u),this.surface.castShadow=!0,this.surface.receiveShadow=!0,this.surface.name=e.id,this.geometry.boundingSphere=new Rn(new W,4*a);let f=d?.vertices??0;this.values=new Float32Array(f),this.colours=new Float32Array(3*f).fill(1),d!==null&&(d.evaluate(e.rest),this.geometry.setIndex(new Ht(d.indices,1)),this.geometry.setAttribute("position",new Ht(d.positions,3)),this.geometry.setAttribute("normal",new Ht(d.normals,3)),this.geometry.setAttribute("color",new Ht(this.colours,3))),this.restPositions=d?.positions.slice()??new Float32Array,this.restNormals=d?.normals.slice()??new Float32Array,this.inwards=d!==null&&K1(d)<0?1:-1,this.group.position.set(...o),this.netPoints=new Float32Array(e.rest.length),this.net=this.makeNet(a),this.lines=this.makeLines(),this.group.add(this.surface,this.lines,this.net)}body;stage;number;group=new hn;extent=[0,0];tessellation;geometry=new nn;surface;lines;net;netPoints;values;colours;restPositions;restNormals;inwards;lattice=null;young=null;size;moved={net:-1,curved:!1};measured={net:-1,what:"",other:-1,inside:null};painted="";makeLines(){let e=new nn,t=this.tessellation;if(t instanceof Sr)e.setAttribute("position",this.geometry.getAttribute("position")),e.setIndex(t.creases),e.boundingSphere=this.geometry.boundingSphere;else if(t instanceof ya){let{u:n,v:s}=t,r=[],o=a=>a.filter((l,c)=>c%Math.ceil(a.length/Z1)===0);for(let a of o(n.knots))for(let l of s.cells)r.push(a*s.count+l,a*s.count+l+1);for(let a of o(s.knots))for(let l of n.cells)r.push(l*s.count+a,(l+1)*s.count+a);e.setAttribute("position",this.geometry.getAttribute("position")),e.setIndex(r),e.boundingSphere=this.geometry.boundingSphere}return new ys(e,new Mi({color:2365974,transparent:!0,opacity:.17,depthWrite:!1}))}makeNet(e){let{u:t,v:n}=this.body.surface,[s,r]=this.body.parted,o=[];for(let u=0;u<t.count;u++)for(let f=0;f<n.count;f++){let g=u*n.count+f;(f+1<n.count?!r.has(f):n.periodic)&&o.push(g,u*n.count+(f+1)%n.count),(u+1<t.count?!s.has(u):t.periodic)&&o.push(g,(u+1)%t.count*n.count+f)}let a=new nn,l=new Ht(this.netPoints,3);a.setAttribute("position",l),a.setIndex(o),a.boundingSphere=new Rn(new W,4*e);let c=new nn;c.setAttribute("position",l),c.boundingSphere=a.boundingSphere;let h=new hn,d=new it("#2f7fd6");return h.add(new ys(a,new Mi({color:d,transparent:!0,opacity:.75})),new Cr(c,new ar({color:d,size:4,sizeAttenuation:!1}))),h}showLattice(e){let{inside:t,nodes:n,nodesVersion:s}=this.body;if(this.lattice!==null&&this.lattice.inside!==t&&(this.lattice.dispose(),this.lattice=null,this.young=null),e&&this.lattice===null&&t!==null&&n!==null){let{x:o,y:a,z:l}=this.group.position;this.lattice=new Qh(t,[o,a,l],this.size),this.group.add(this.lattice.group)}let r=e&&this.lattice!==null&&n!==null&&this.body.fault===null;return this.lattice!==null&&(this.lattice.group.visible=r),r&&n!==null&&this.lattice?.place(n,s),r}setLayers(e,t,n,s,r){let o=this.showLattice(s),{material:a}=this.surface;a.transparent!==o&&([a.transparent,a.opacity,a.depthWrite,a.needsUpdate]=[o,o?.28:1,!o,!0]);let l=this.body.fault===null;this.surface.visible=e&&l&&this.tessellation!==null,this.net.visible=(n||this.tessellation===null)&&l&&!Mr(this.body),this.lines.visible=t&&l&&this.tessellation!==null;let c=r?[this.stage.clip]:null;for(let h of[this.surface.material,this.lines.material])h.clippingPlanes===null!=(c===null)&&(h.needsUpdate=!0),h.clippingPlanes=c}move(e){let{body:t,tessellation:n}=this,s=e==="curvature";if(this.moved.net===t.netVersion&&(this.moved.curved||!s)||(this.moved={net:t.netVersion,curved:s},t.fault!==null||n!==null&&n.evaluate(t.points,s)>=0))return;let{x:r,y:o,z:a}=this.group.position;for(let l=0;l<t.points.length;l+=3)this.netPoints[l]=t.points[l]-r,this.netPoints[l+1]=t.points[l+1]-o,this.netPoints[l+2]=t.points[l+2]-a;for(let l of["position","normal"]){let c=this.geometry.getAttribute(l);c!==void 0&&(c.needsUpdate=!0)}for(let l of this.net.children)l.geometry.getAttribute("position").needsUpdate=!0}update(e,t){this.move(e),e==="difference"&&t?.move(e);let n=e==="difference"&&t!==null?t.body.netVersion:-1,{measured:s}=this,{inside:r}=this.body;s.net===this.body.netVersion&&s.what===e&&s.other===n&&s.inside===r||(s.inside!==r&&(this.young=null),this.measured={net:this.body.netVersion,what:e,other:n,inside:r},!(this.tessellation===null||this.body.fault!==null)&&(this.measure(e,this.tessellation,t),this.painted=""))}measure(e,t,n){let{values:s,restPositions:r,restNormals:o}=this,a=t.positions,l=n?.tessellation?.positions,c=e==="stiffness"?this.youngNow():null,[h,d]=[1/0,-1/0];for(let u=0;u<s.length;u++){let f=3*u,g=e==="difference"&&l?.length===a.length?l:r,[y,p,m]=[a[f]-g[f],a[f+1]-g[f+1],a[f+2]-g[f+2]],x=0;e==="displacement"||e==="difference"?x=Math.sqrt(y*y+p*p+m*m):e==="indentation"?x=Math.max(0,this.inwards*(y*o[f]+p*o[f+1]+m*o[f+2])):e==="curvature"?x=this.inwards*t.curvature[u]:e==="stiffness"&&(x=c?.[u]??0),s[u]=x,x<h&&(h=x),x>d&&(d=x)}if(e==="curvature"){let u=Float32Array.from(s).sort();h=u[Math.floor(.02*u.length)],d=u[Math.floor(.98*(u.length-1))]}this.extent=s.length>0?[h,d]:[0,0]}youngNow(){let{inside:e}=this.body;if(e===null)return null;let{x:t,y:n,z:s}=this.group.position;return this.young??=xm(e,this.restPositions,[t,n,s]),this.young}paint(e,t){let n=e===null?t:`${t} ${e.map} ${e.from} ${e.to}`;if(n===this.painted)return;if(this.painted=n,e===null){let r=new it(W0[t==="body"?this.number%W0.length:0]);for(let o=0;o<this.colours.length;o+=3)this.colours.set([r.r,r.g,r.b],o)}else hl(this.values,e.from,e.to,e.map,this.colours);let s=this.geometry.getAttribute("color");s!==void 0&&(s.needsUpdate=!0)}dispose(){this.lattice?.dispose(),this.geometry.dispose(),this.surface.material.dispose(),this.lines.geometry.dispose(),this.lines.material.dispose();for(let e of this.net.children)e.geometry.dispose(),e.material.dispose();this.group.removeFromParent()}};function K1({positions:i,indices:e}){let t=0;for(let n=0;n<e.length;n+=3){let[s,r,o]=[3*e[n],3*e[n+1],3*e[n+2]];t+=i[s]*(i[r+1]*i[o+2]-i[r+2]*i[o+1])+i[s+1]*(i[r+2]*i[o]-i[r]*i[o+2])+i[s+2]*(i[r]*i[o+1]-i[r+1]*i[o])}return t}var Uf=256,tu=class{group=new hn;dots=new ka(new Ir(1,14,10),new rr,Uf);at=new Float32Array(6*Uf);normals;constructor(){let e=new nn;e.setAttribute("position",new Ht(this.at,3)),e.boundingSphere=new Rn(new W,1e3),this.normals=new ys(e,new Mi),this.dots.frustumCulled=!1,this.group.add(this.dots,this.normals)}setLook(e){this.dots.material.color.set(e),this.normals.material.color.set(e)}update(e,t){let n=e.filter(({point:a,normal:l})=>[...a,...l].every(Number.isFinite)).slice(0,Uf),s=new Mt,[r,o]=[.006*t,.07*t];n.forEach(({point:a,normal:l},c)=>{s.makeScale(r,r,r).setPosition(...a),this.dots.setMatrixAt(c,s);for(let h=0;h<3;h++)this.at[6*c+h]=a[h],this.at[6*c+3+h]=a[h]+o*l[h]}),this.dots.count=n.length,this.dots.instanceMatrix.needsUpdate=!0,this.normals.geometry.setDrawRange(0,2*n.length),this.normals.geometry.getAttribute("position").needsUpdate=!0}};var nu=class{last=[];changed(e){let{last:t}=this,[n,s]=[0,!1];for(let r of e){let o=Math.round(r)+0;s||=!Object.is(o,t[n]),t[n]=o,n+=1}return s||=n!==t.length,t.length=n,s}};var J1=new W(0,1,0),j1=new Lo(1,1,1,16).translate(0,.5,0),X0=new Ga(1,1,24).translate(0,.5,0),ul=class{constructor(e,t=1){this.heads=t;this.material=new Os({color:e,emissive:e,emissiveIntensity:.45,specular:2236962}),this.shaft=new Zt(j1,this.material),this.head=new Zt(X0,this.material),this.group.add(this.shaft,this.head),t===2&&this.group.add(new Zt(X0,this.material)),this.group.visible=!1}heads;group=new hn;material;shaft;head;tip=new W;setColour(e){this.material.color.set(e),this.material.emissive.set(e)}set(e,t,n,s){let r=kt(t)*n;if(this.group.visible=r>.4*s&&Number.isFinite(r),!this.group.visible)return;let o=Math.min(5*s,.6*r),a=r-o;this.group.position.set(...e),this.group.quaternion.copy(new oi().setFromUnitVectors(J1,new W(...t).normalize())),this.shaft.scale.set(s,Math.max(a,1e-9),s);for(let l=0;l<this.heads;l++){let c=this.group.children[1+l];c.scale.set(2.3*s,o,2.3*s),c.position.y=a-.7*l*o}this.tip.copy(new W(0,r,0)).applyQuaternion(this.group.quaternion).add(this.group.position)}dispose(){this.material.dispose(),this.group.removeFromParent()}};var kf=6,Of=8*kf+1;function Q1(i){if(i===void 0||i.triangles.length===0)return null;let e=new nn;return e.setAttribute("position",new Ht(new Float32Array(i.points.flat()),3)),e.setIndex(i.triangles.flat()),e.computeVertexNormals(),e.computeBoundingSphere(),e}var iu=class{constructor(e,t,n,s){this.tool=e;let r=Q1(t)??new Ir(e.radius>0?e.radius:.012*n,32,20);r.computeBoundingSphere(),this.reach=r.boundingSphere?.radius??n/50;let o=e.shape==="plane";this.shape=new Zt(r,new Os({color:s.tool,specular:4868682,shininess:90,side:Kn,transparent:o,opacity:o?.35:1,depthWrite:!o})),this.shape.castShadow=!o,this.shape.name=e.id,this.ghost=new Zt(r,new rr({color:s.hand,wireframe:!0,transparent:!0,opacity:.28,depthWrite:!1}));let a=new nn;a.setAttribute("position",new Ht(this.springAt,3)),a.boundingSphere=new Rn(new W,1e3),this.spring=new Po(a,new Mi({color:s.force,depthTest:!1,transparent:!0,opacity:.95})),this.spring.renderOrder=5,this.arrow=new ul(s.force),this.torque=new ul(s.torque,2),this.group.add(this.shape,this.ghost,this.spring,this.arrow.group,this.torque.group)}tool;group=new hn;shape;arrow;torque;reach;ghost;spring;springAt=new Float32Array(3*Of);setLook(e,t){this.shape.material.color.set(t?e.focus:e.tool),this.ghost.material.color.set(e.hand),this.spring.material.color.set(e.force),this.arrow.setColour(e.force),this.torque.setColour(e.torque)}update(e,t,n){let{tool:s}=this,r=s.proxy.every(Number.isFinite)&&s.orientation.every(Number.isFinite);if(this.group.visible=r,!r)return;this.shape.visible=e.tools,this.shape.position.set(...s.proxy),this.shape.quaternion.set(...s.orientation);let{hand:o}=s,a=o===null?0:kt(Wi(o.position,s.proxy)),l=e.hands&&o!==null&&a>Math.max(.004*n,.08*Math.min(this.reach,n))&&Number.isFinite(a);this.ghost.visible=l,this.spring.visible=l,l&&o!==null&&(this.ghost.position.set(...o.position),this.ghost.quaternion.set(...o.orientation),this.coil(s.proxy,o.position,Math.min(.01*n,.25*a)));let c=.0075*n;if(e.forces){let h=kt(s.force),d=h>0&&s.shape!=="plane"?Math.min(this.reach,.2*n):0;this.arrow.set(yi(s.proxy,Ut(s.force,d/(h||1))),s.force,t,c)}else this.arrow.group.visible=!1;e.torques?this.torque.set(s.proxy,s.torque,t/(.2*n),.8*c):this.torque.group.visible=!1}coil(e,t,n){let s=Wi(t,e),r=kt(s)||1,o=Ut(s,1/r),a=Math.abs(o[2])<.9?[0,0,1]:[1,0,0],l=Wi(a,Ut(o,io(a,o))),c=Ut(l,n/kt(l)),h=[o[1]*c[2]-o[2]*c[1],o[2]*c[0]-o[0]*c[2],o[0]*c[1]-o[1]*c[0]];for(let d=0;d<Of;d++){let u=d/(Of-1),f=Math.min(1,8*Math.min(u,1-u)),[g,y]=[Math.cos(2*Math.PI*kf*u)*f,Math.sin(2*Math.PI*kf*u)*f];for(let p=0;p<3;p++)this.springAt[3*d+p]=e[p]+s[p]*u+c[p]*g+h[p]*y}this.spring.geometry.getAttribute("position").needsUpdate=!0}dispose(){this.shape.geometry.dispose(),this.shape.material.dispose(),this.ghost.material.dispose(),this.spring.geometry.dispose(),this.spring.material.dispose(),this.arrow.dispose(),this.torque.dispose(),this.group.removeFromParent()}};var eT=.14,dl=1e-4;function tT(i){let e=new ci;for(let t of i.bodies)e.take(t.rest);return!e.empty&&e.high[2]-e.low[2]<.1*e.size}var su=class{constructor(e,t){this.world=e;this.stage=t;t.content.add(this.group),this.group.add(this.contacts.group)}world;stage;group=new hn;bodies=[];tools=[];scale=null;arrowScale=.01;size=.1;middle=[0,0,0];groundZ=0;contacts=new tu;shown=new nu;range=new cl;forceRange=new cl;seen={scene:-1,outlines:-1,what:"",settings:-1};rebuild(e){let{world:t,seen:n}=this,s=n.scene!==t.sceneVersion;if(!s&&n.outlines===t.outlineVersion)return!1;if(n.outlines=t.outlineVersion,s||t.bodies.some(Mr)){for(let o of this.bodies)o.dispose();this.bodies=t.bodies.map((o,a)=>new eu(o,this.stage,a,t.bodies.length,t.outlineOf(o)));for(let o of this.bodies)this.group.add(o.group)}if(s){n.scene=t.sceneVersion;let o=t.bounds();this.size=o.size,this.middle=o.middle,this.groundZ=o.empty?0:o.low[2]-(tT(t)?eT*o.size:0),this.range.reset(),this.forceRange.reset()}for(let o of this.tools)o.dispose();return this.tools=t.tools.map(o=>{let a=t.outlines.find(({id:c,shape:h})=>c===o.id&&h!=="part"),l=new iu(o,a,this.size,e);return this.group.add(l.group),l}),n.settings=-1,s}update(e,t,n,s,r){let{world:o}=this,a=performance.now(),l=e.colourBy;this.seen.what!==l&&(this.seen.what=l,this.range.reset());for(let d of this.bodies)d.update(l,r?.bodies.find(({body:u})=>u.id===d.body.id)??null);this.scale=this.scaleNow(e,a);let c=e.clip!=="off";for(let d of this.bodies)d.paint(this.scale,l),d.setLayers(e.layers.surface,e.layers.lines,e.layers.net,e.layers.lattice,c);if(this.seen.settings!==t){this.seen.settings=t;for(let d of this.tools)d.setLook(n,d.tool.id===s);this.contacts.setLook(n.contact)}let h=Math.max(0,...o.tools.map(d=>kt(d.force)).filter(Number.isFinite));this.arrowScale=.34*this.size/this.forceRange.follow(h,.5,a,!1);for(let d of this.tools)d.update(e.layers,this.arrowScale,this.size);return this.contacts.group.visible=e.layers.contacts,this.contacts.update(o.contacts,this.size),this.shown.changed(this.figures(t,r))}*figures(e,t){let{world:n,size:s,arrowScale:r}=this,o=dl*s;yield*[this.seen.scene,this.seen.outlines,e];for(let a of[this.scale?.from??0,this.scale?.to??0,r])yield Math.log(Math.abs(a)+Number.MIN_VALUE)/dl;for(let{netVersion:a,nodesVersion:l,fault:c,inside:h}of[...n.bodies,...t?.world.bodies??[]])yield*[a,l,c===null?0:1,h===null?0:1];for(let{proxy:a,orientation:l,force:c,torque:h,hand:d}of n.tools){for(let u of[0,1,2])yield*[a[u]/o,c[u]*r/o,h[u]*r/(s*o)],yield(d?.position[u]??0)/o;for(let u of[0,1,2,3])yield*[l[u]/dl,(d?.orientation[u]??0)/dl]}for(let{point:a,normal:l}of n.contacts)for(let c of[0,1,2])yield*[a[c]/o,l[c]/dl]}scaleNow(e,t){let n=H0(e);if(n===null||this.bodies.length===0)return null;let s=Math.min(...this.bodies.map(a=>a.extent[0])),r=Math.max(...this.bodies.map(a=>a.extent[1]));if(e.colourBy==="curvature"){let a=this.range.follow(Math.max(Math.abs(s),Math.abs(r)),.001/this.size,t,e.lockRange);return{...n,from:-a,to:a}}if(e.colourBy==="stiffness")return{...n,from:0,to:this.range.follow(r,1,t,e.lockRange)};let o=e.colourBy==="difference"?1e-6*this.size:pr(this.size/200);return{...n,from:0,to:this.range.follow(r,o,t,e.lockRange)}}dispose(){for(let e of this.bodies)e.dispose();for(let e of this.tools)e.dispose();this.group.removeFromParent()}};var nT={theme:"system",colourBy:"displacement",map:"ember",lockRange:!1,layers:{surface:!0,lines:!0,net:!1,lattice:!1,contacts:!0,tools:!0,hands:!0,forces:!0,torques:!1,labels:!0,grid:!0,shadows:!0},clip:"off",clipAt:.5,clipFlip:!1,sound:!1,span:10},q0="palpate.page.1";function iT(i){return{...i,layers:{...i.layers}}}function sT(){let i=iT(nT);try{let e=JSON.parse(localStorage.getItem(q0)??"{}");["system","light","dark"].includes(e.theme??"")&&(i.theme=e.theme),["ember","viridis","cividis"].includes(e.map??"")&&(i.map=e.map),[5,10,30,60].includes(e.span??0)&&(i.span=e.span);for(let t of Object.keys(i.layers)){let n=e.layers?.[t];typeof n=="boolean"&&(i.layers[t]=n)}}catch{}return i}var ru=class{value=sT();version=0;listeners=[];onChange(e){this.listeners.push(e)}set(e){e(this.value),this.version+=1;try{localStorage.setItem(q0,JSON.stringify(this.value))}catch{}for(let t of this.listeners)t()}};async function fl(){if(!location.protocol.startsWith("http"))return null;try{let i=await fetch("session.json",{cache:"no-store"});return i.ok?await i.json():null}catch{return null}}function $0(i){let e=atob(i.replace(/\s+/g,"")),t=new Uint8Array(e.length);for(let n=0;n<e.length;n++)t[n]=e.charCodeAt(n);return t}function Y0(){let i=document.getElementById("palpate-recording");if(i===null)return null;let e=document.getElementById("palpate-scene")?.textContent??"";return{name:i.dataset.name??"recording",bytes:$0(i.textContent??""),scene:e.trim()===""?null:$0(e),tools:document.getElementById("palpate-tools")?.textContent??null}}var ou=class{context=null;tone=null;volume=null;set(e){if(!e){this.context?.close(),this.context=this.tone=this.volume=null;return}this.context===null&&(this.context=new AudioContext,this.tone=new OscillatorNode(this.context,{type:"triangle",frequency:110}),this.volume=new GainNode(this.context,{gain:0}),this.tone.connect(this.volume).connect(this.context.destination),this.tone.start())}update(e){if(this.context===null||this.tone===null||this.volume===null)return;let t=Math.min(Math.max(e,0),1)||0,n=this.context.currentTime;this.tone.frequency.setTargetAtTime(110*2**(3*Math.sqrt(t)),n,.015),this.volume.gain.setTargetAtTime(t>.002?.05+.12*t:0,n,.02)}};var rT={latch:"reading poses",render:"contact",deform:"deformation",hash:"the state hash",emit:"sending",wake:"the system woke it late"},Ti=(i,e,t=!1)=>({about:i,serious:t,text:e});function Br(i,e,t,n=!1){let s=r=>r===1n?e:t(r);return{...Ti(i,e,n),repeated:{kind:e,count:1n,worst:0n,words:s}}}function oT(i){let e=s=>`Fault${s===1n?"":`, ${s} times`}: ${i}. Forces are safe, not right`,t=/^the loop runs at (\d{1,9}) of (\d{1,9}) Hz/.exec(i);if(t===null)return Br("fault",e(1n),e,!0);let n=(s,r)=>s===1n?e(1n):`Fault, ${s} times: the loop runs at ${-r} of ${t[2]} Hz at its slowest; forces fade until it keeps its rate. Forces are safe, not right`;return{...Ti("fault",e(1n),!0),repeated:{kind:"slow",count:1n,worst:-BigInt(t[1]),words:n}}}function aT(i,e){let t=i===0?`Full quality again, ${e}`:`Quality is at level ${i} (${Bf[i]??"less work"}), ${e}`;return Ti("loop",t,i>0&&!/^raised|in good time/.test(e))}function Z0(i){switch(i.type){case"Reset":return Ti("loop","Reset to the start of the scene");case"Paused":return Ti("loop","Paused");case"Resumed":return Ti("loop","Running again");case"ToolJoined":return Br("tool",`${i.tool} is being moved`,e=>`${i.tool} is being moved (${e} times)`);case"ToolLost":return Br("tool",`${i.tool} is not moved any more`,e=>`${i.tool} is not moved any more (${e} times)`);case"PoseRefused":{let e=t=>`${t===1n?"A pose":`${t} times a pose`} of ${i.tool} was refused: ${i.reason}`;return Br("tool",e(1n),e,!0)}case"ForceWithheld":{let e=t=>`${i.tool} is inside a body: no force until it is out of it${t===1n?"":` (${t} times)`}`;return Br("tool",e(1n),e)}case"ForceDegraded":{let e=t=>`The force of ${i.tool} is less accurate than asked for${t===1n?"":` (${t} times)`}: ${i.reason}`;return Br("tool",e(1n),e)}case"ForceRestored":return Br("tool",`The force of ${i.tool} is accurate again`,e=>`The force of ${i.tool} is accurate again (${e} times)`);case"Fault":return oT(i.reason);case"RecordStarted":return Ti("recorder",`Recording to ${i.path}`);case"RecordStopped":return Ti("recorder",`Recorded ${i.path}`);case"Stopping":return Ti("loop","The daemon is going down");case"Overrun":{let e=rT[i.stage]??i.stage,t=(s,r)=>`${s===1n?"1 tick was":`${s} ticks were`} late, the worst by ${ns(Number(r)*1e-9,"s")}: ${e}`,n={kind:`late ${i.stage}`,count:i.count,worst:i.worst_ns,words:t};return{...Ti("loop",t(i.count,i.worst_ns)),repeated:n}}case"QualityChanged":return aT(i.level,i.reason);case"DeviceTold":return Ti("tool",`The device of ${i.tool} is ${i.name===""?"one without a name":i.name}`);case"RecordFailed":return Ti("recorder",`Recording ${i.path} failed: ${i.reason}`,!0);case"SceneChanged":return Ti("scene",`The scene changed: ${i.what}`)}}function K0(i){return{tick:Number(i.tick),seq:Number(i.seq),...Z0(i.kind)}}function lT(i,e){let[t,...n]=e.split(": "),s=n.join(": ");switch(i){case"reset":return{type:"Reset"};case"paused":return{type:"Paused"};case"resumed":return{type:"Resumed"};case"stopping":return{type:"Stopping"};case"tool_joined":return{type:"ToolJoined",tool:e};case"tool_lost":return{type:"ToolLost",tool:e};case"pose_refused":return{type:"PoseRefused",tool:t,reason:s};case"force_withheld":return{type:"ForceWithheld",tool:e};case"force_degraded":return{type:"ForceDegraded",tool:t,reason:s};case"force_restored":return/^\d{1,15} ticks$/.test(s)?{type:"ForceRestored",tool:t,ticks:BigInt(s.split(" ")[0])}:null;case"fault":return{type:"Fault",reason:e};case"record_started":return{type:"RecordStarted",path:e};case"record_stopped":return{type:"RecordStopped",path:e};case"record_failed":return{type:"RecordFailed",path:t,reason:s};case"quality_changed":return/^\d$/.test(t)?{type:"QualityChanged",level:Number(t),reason:s}:null;case"device_told":return{type:"DeviceTold",tool:t,name:s};case"scene_changed":return{type:"SceneChanged",what:e};case"overrun":{let r=/^(.*): (\d{1,18}) ticks, worst (\d{1,18}) ns$/.exec(e);return r===null?null:{type:"Overrun",stage:r[1],count:BigInt(r[2]),worst_ns:BigInt(r[3])}}default:return null}}function J0(i,e,t,n){let s=e.replace(/([a-z])([A-Z])/g,"$1_$2").replace(/[ -]/g,"_").toLowerCase(),r=lT(s,t);if(r!==null)return{tick:i,seq:n,...Z0(r)};let o=s.replace(/_/g," ")+(t===""?"":`: ${t}`);return{tick:i,seq:n,about:"loop",serious:/fault|refused|failed/.test(s),text:o.charAt(0).toUpperCase()+o.slice(1)}}var cT=[[en.FAULT,"fault: the force is safe, not right",0],[en.REFUSED,"the last pose was refused",en.SATURATED|en.RAMPING],[en.STALE,"no fresh pose",en.SATURATED|en.RAMPING|en.GRABBING],[en.WITHHELD,"inside a body: no force until it is out of it",0],[en.PAUSED,"paused",en.SATURATED|en.RAMPING],[en.RAMPING,"force ramping up",en.SATURATED],[en.SATURATED,"at the force limit",0],[en.GRABBING,"gripping",0],[en.DAMPED,"damped",0],[en.DEGRADED,"less accurate than asked for",0]];function j0(i,e=!1){let t=[],n=i;for(let[s,r,o]of cT)(n&s)!==0&&(n&=~o,e&&s===en.STALE||t.push(r));return t}var Q0={Off:"not recording",Recording:"recording",Ring:"last seconds kept",Failed:"recording failed"},Bf=["full quality","bodies iterate once","fewer contact sweeps","nets ten times rarer"];var ey=10,hT=20,au=class{newest=new Map;clock=0;looked=null;tick(e){return this.clock+=Math.min(e-(this.looked??e),hT),this.looked=e,this.clock}take(e,t,n=performance.now()){let s=this.tick(n),r=this.newest.get(e.id),o=r?.dog.gain(s)===1?r.dog:new da(!0);o.heard(s),this.newest.set(e.id,{dog:o,force:t,gain:1}),e.force=t.force,e.torque=t.torque}look(e,t,n=performance.now()){t&&(this.looked=n);let s=this.tick(n),r=!1;for(let o of e.tools){let a=this.newest.get(o.id),l=a?.dog.gain(s)??1;if(a===void 0||l===a.gain)continue;a.gain=l;let c=a.dog.felt(a.force,s);o.force=c.force,o.torque=c.torque,r=!0}return r}drop(e){this.newest.clear();for(let t of e.tools)t.force=t.torque=[0,0,0]}};function ty(i){let e=new Ks(i);return{key:mt.read(e),payload:i.subarray(e.at)}}function zf(i,e=new Uint8Array){let t=new Js;return mt.write(t,i),t.raw(e),t.finish()}function Vf(i){return mt.read(new Ks(i))}function ny(i){let e=new Js;return mt.write(e,i),e.finish()}function iy(i,e){let t=new Js;return $e.write(t,BigInt(i)),mt.write(t,e),t.finish()}function sy(i){let e=new Ks(i);return{id:Number($e.read(e)),json:mt.read(e)}}var uT=3e4,dT=8e3,lu=class{constructor(e,t){this.world=e;this.session=t}world;session;onRefused=()=>{};onOpen=()=>{};socket=null;calls=new Map;nextCall=1;attempts=0;timer;neighbours;fading=new au;fader;closed=!1;looking=!1;insideAsked=!1;malformed=0;get mayWrite(){return this.session.token!==null&&this.world.link==="live"}get viewOnly(){return this.session.token===null}get mayHold(){return this.mayWrite&&this.session.played!==!0}get lockstep(){return this.session.lockstep===!0||this.world.lockstep}get pages(){return this.session.pages??{}}get instance(){return this.session.instance??"default"}async lookAround(){if(document.hidden||this.world.link!=="live")return;let e=await fl();if(e===null||this.closed)return;let{instances:t=[],pages:n={}}=e;this.session={...this.session,instances:t,pages:n},this.world.instances=t}start(){clearInterval(this.neighbours),this.neighbours=setInterval(()=>{this.lookAround()},dT),clearInterval(this.fader),this.fader=setInterval(()=>this.fade(),ey),this.world.instances=this.session.instances??[];let e=location.protocol==="https:"?"wss":"ws",t=new WebSocket(`${e}://${location.host}/live`);this.socket=t,t.binaryType="arraybuffer",t.onopen=()=>{this.attempts=0,this.session.token!==null&&t.send(zf("token",ny(this.session.token))),this.world.link="live",this.world.trouble="",this.world.touch(),this.fetchOutlines(),this.onOpen(),this.insideAsked=!1,this.looking&&this.send("inside",Uint8Array.of(1))},t.onmessage=n=>{n.data instanceof ArrayBuffer&&this.take(new Uint8Array(n.data))},t.onclose=()=>this.lose()}stop(){this.closed=!0,clearInterval(this.neighbours),clearInterval(this.fader),clearTimeout(this.timer),this.socket?.close()}lose(){if(!this.closed){this.world.link="lost",this.world.trouble="The daemon does not answer; trying again …";for(let e of this.world.tools)e.holder=null;this.fading.drop(this.world),this.world.touch();for(let e of this.calls.values())e({ok:!1,error:"the connection was lost"});this.calls.clear(),this.attempts+=1,this.timer=setTimeout(()=>{this.again()},Math.min(250*this.attempts,2e3))}}async again(){let e=await fl();if(!this.closed){if(e===null)return this.lose();this.session=e,this.start()}}async fetchOutlines(){try{let e=await fetch("tools.json",{cache:"no-store"});this.world.outlines=await e.json(),this.world.outlineVersion+=1,this.world.touch()}catch{}}take(e){this.world.heard=performance.now();try{let{key:t,payload:n}=ty(e);this.route(t,n)}catch(t){if(!(t instanceof An||t instanceof SyntaxError))throw t;t instanceof An&&t.fault==="unknown-case"||(this.malformed+=1)}}route(e,t){let[n,s,r]=e.split("/"),{world:o}=this;switch(r===void 0?n:`${n}/${r}`){case"scene":{o.load(_i(Bl,t)),o.insides.length===0&&(this.insideAsked=!1),this.fetchOutlines();return}case"body/net":{let a=_i(am,t);o.body(a.body)?.takeNet(a.points,a.count_u,a.count_v,Number(a.tick));break}case"body/nodes":return this.takeNodes(s,t);case"tool/force_v2":{let a=this.world.tool(s);a!==void 0&&(a.error=_i(rm,t).error_n);return}case"tool/force":return this.takeForce(s,_i(sm,t));case"tool/contact":{let a=o.tool(s),l=_i(om,t);if(a===void 0)return;a.contactForce=l.force,a.energy=l.energy_j,a.dissipated=l.dissipated_j;break}case"tool/device":{let a=o.tool(s);a!==void 0&&(a.device=_i(rd,t));break}case"contact":o.contacts=_i(lm,t).contacts;break;case"status":this.takeStatus(_i(cm,t));break;case"event":o.addEvent(K0(_i(hm,t)));return;case"holders":{let a=JSON.parse(Vf(t));for(let l of o.tools)l.holder=a[l.id]??null,l.holder===null&&(l.device=null);break}case"rpc":{let{id:a,json:l}=sy(t);this.calls.get(a)?.(JSON.parse(l)),this.calls.delete(a);return}case"refused":{let a=JSON.parse(Vf(t));this.onRefused(a.key??"",a.error??"refused");return}default:return}o.touch()}lookInside(e,t){e!==this.looking&&(this.looking=e,this.send("inside",Uint8Array.of(e?1:0))),(e||t)&&!this.insideAsked&&this.world.link==="live"&&(this.insideAsked=!0,this.fetchInside())}async fetchInside(){try{let e=await fetch("inside.json",{cache:"no-store"});this.world.setInsides(Xl(await e.json()))}catch{}}takeNodes(e,t){let n=this.world.body(e);n===void 0||t.length<8||(t.length-8)%12!==0||(n.nodes=new Float32Array(t.slice(8).buffer),n.nodesVersion+=1,this.world.touch())}fade(){let e=this.lockstep||this.session.played===!0||this.world.status?.state!=="Running";this.fading.look(this.world,e)&&this.world.touch()}takeForce(e,t){let n=this.world.tool(e);if(n===void 0)return;let s=Number(t.tick);n.tick=s,this.fading.take(n,t),n.proxy=t.proxy_position,n.orientation=t.proxy_orientation,n.depth=t.depth,n.contacts=t.contact_count,n.flags=t.flags,n.hand!==null&&(n.poseAgeMs=performance.now()-Number(t.t_client_ns)*1e-6),this.world.tick=s,n.history.push(s,...t.force,t.depth,n.energy,n.dissipated,n.error),this.world.touch()}takeStatus(e){let{world:t}=this,n=Number(e.tick),s=r=>Number(r)*1e-9;n!==t.tick&&(t.tick=n),t.status=e,t.loop.push(n,s(e.step.p50_ns),s(e.step.p99_ns),s(e.step.max_ns),s(e.period.max_ns),e.rate_hz);for(let r of t.tools)n>r.tick&&r.history.push(n,...r.force,r.depth,r.energy,r.dissipated,r.error)}claim(e,t){this.send(`tool/${e}/device`,Ol(rd,t))}pose(e,t){this.send(`tool/${e}/pose`,Ol(im,t))}release(e){this.send(`tool/${e}/release`,new Uint8Array)}speed(e){let t=new Uint8Array(8);new DataView(t.buffer).setFloat64(0,e,!0),this.send("speed",t)}call(e,t={}){if(!this.mayWrite){let s=this.viewOnly?"this page is for looking only":"there is no connection to the daemon";return Promise.resolve({ok:!1,error:s})}let n=this.nextCall++;return new Promise(s=>{let r=setTimeout(()=>{this.calls.delete(n),s({ok:!1,error:"no answer within 30 s"})},uT);this.calls.set(n,o=>{clearTimeout(r),s(o)}),this.send(`rpc/${e}`,iy(n,JSON.stringify(t)))})}send(e,t){this.socket?.readyState===WebSocket.OPEN&&this.socket.send(zf(e,t))}};var cu=class{constructor(e){this.recording=e;let t=e.lastTick-e.firstTick+1;this.ticksPerRow=Math.max(1,Math.ceil(t/6e3)),this.rows=Math.max(1,Math.ceil(t/this.ticksPerRow)),this.filled=new Uint8Array(this.rows);let n=()=>new Float64Array(this.rows);this.tools=e.toolIds.map(()=>({fx:n(),fy:n(),fz:n(),size:n(),error:n(),depth:n(),energy:n(),dissipated:n(),contact:new Uint8Array(this.rows)})),this.step=n(),this.late=n()}recording;rows;ticksPerRow;filled;tools;step;late;events=[];version=0;done=!1;sampled=1;stopped=!1;tickOf(e){return this.recording.firstTick+e*this.ticksPerRow}stop(){this.stopped=!0}async fill(){let{chunks:e,channels:t}=this.recording.file,n=e.reduce((a,l)=>a+l.length,0);this.sampled=Math.max(1,Math.ceil(n/67108864));let s=[...t].find(([,a])=>a==="/sim/event")?.[0]??-1,r=performance.now(),o=400;for(let a=0;a<e.length&&!this.stopped;a++){if(a%this.sampled!==0&&(!(e[a].channels?.has(s)??!1)||o--<=0))continue;let l=await this.recording.passing(a);this.events.push(...l.events);for(let c of l.ticks)this.take(c);performance.now()-r>24&&(this.version+=1,await new Promise(c=>setTimeout(c)),r=performance.now())}this.events.sort((a,l)=>a.tick-l.tick),this.done=!0,this.version+=1}take(e){let t=Math.floor((e.tick-this.recording.firstTick)/this.ticksPerRow);t<0||t>=this.rows||(this.filled[t]=1,this.step[t]=Math.max(this.step[t],1e-9*e.stagesNs.reduce((n,s)=>n+s,0)),this.late[t]=Math.max(this.late[t],1e-9*e.lateNs),e.tools.forEach(({values:n,contacts:s,contact:r},o)=>{let a=this.tools[o];if(a===void 0||n.length<21)return;let l=Math.hypot(n[0],n[1],n[2]);l>=a.size[t]&&([a.fx[t],a.fy[t],a.fz[t],a.size[t]]=[n[0],n[1],n[2],l],a.error[t]=n[21]??0),a.depth[t]=Math.max(a.depth[t],r?.values[8]??0),a.energy[t]=n[19],a.dissipated[t]=n[20],s>0&&(a.contact[t]=1)}))}contactIntervals(e){let t=[],{contact:n}=this.tools[e],s=Math.max(this.ticksPerRow,this.recording.every);for(let r=0;r<this.rows;r++){if(n[r]===0)continue;let o=t[t.length-1],a=this.tickOf(r)+s-1;o!==void 0&&this.tickOf(r)-o[1]<=1+s*(this.sampled-1)?o[1]=a:t.push([this.tickOf(r),a])}return t}};var pl=class{ticks=[];columns=Array.from({length:7},()=>[]);version=0;push(e,...t){let n=this.ticks[this.ticks.length-1];if(n!==void 0&&e<n){if(n-e<500)return;this.clear()}if(e===n?this.columns.forEach((s,r)=>s[s.length-1]=t[r]??0):(this.ticks.push(e),this.columns.forEach((s,r)=>s.push(t[r]??0))),this.ticks.length>4096*1.25){let s=this.ticks.length-4096;this.ticks.splice(0,s);for(let r of this.columns)r.splice(0,s)}this.version+=1}clear(){this.ticks=[];for(let e of this.columns)e.length=0;this.version+=1}};var ml=class{constructor(e,t,n,s,r,o){this.id=e;this.model=t;this.surface=n;this.rest=s;this.assumed=o;this.points=r}id;model;surface;rest;assumed;points;netTick=0;netVersion=1;fault=null;inside=null;nodes=null;nodesVersion=1;get parted(){return this.surface.u.degree===0?[new Set,new Set]:[ga(this.surface.u),ga(this.surface.v)]}takeNet(e,t,n,s){if(t!==this.surface.u.count||n!==this.surface.v.count||e.length!==3*t*n)return!1;let r=e.some((a,l)=>a!==this.points[l]);if(this.points=e,this.netTick=s,!r)return!0;this.netVersion+=1;let o=e.findIndex(a=>!Number.isFinite(a));return this.fault=o<0?null:`control point ${Math.floor(o/3)} of ${this.id} is not a number`,!0}},gl=class{constructor(e,t,n,s,r){this.id=e;this.shape=t;this.radius=n;this.forceMax=s;this.start=r;this.proxy=r.position,this.orientation=r.orientation}id;shape;radius;forceMax;start;proxy;orientation;force=Ii;torque=Ii;contactForce=Ii;error=0;depth=0;contacts=0;flags=0;energy=0;dissipated=0;tick=0;poseAgeMs=0;hand=null;device=null;holder=null;history=new pl},ry=1e3,oy=4e3,fT=128,Wo=class{name="";sceneHash="";dt=.001;lockstep=!1;bodies=[];tools=[];outlines=[];insides=[];contacts=[];status=null;events=[];instances=[];link="connecting";heard=0;trouble="";tick=0;version=0;sceneVersion=0;outlineVersion=0;eventVersion=0;historyVersion=0;loop=new pl;seconds(e=this.tick){return e*this.dt}touch(){this.version+=1}setInsides(e){this.insides=e;let t=new Map(e.map(n=>[n.id,n]));for(let n of this.bodies)n.inside=t.get(n.id)??null;this.touch()}outlineOf(e){return this.outlines.find(({id:t,shape:n})=>t===e.id&&n==="part")}body(e){return this.bodies.find(t=>t.id===e)}tool(e){return this.tools.find(t=>t.id===e)}load(e){let t=new Map(this.tools.map(r=>[r.id,r])),n=this.sceneHash;this.name=e.scene_name,this.sceneHash=[...e.scene_hash].map(r=>r.toString(16).padStart(2,"0")).join(""),this.dt=Number(e.dt_ns)*1e-9||.001,this.lockstep=e.lockstep,this.tick=Number(e.tick),this.sceneHash!==n&&(this.insides=[]);let s=new Map(this.insides.map(r=>[r.id,r]));this.bodies=e.bodies.map(r=>{let o=h=>({degree:r.degree[h],periodic:r.periodic[h],count:r.count[h],knots:r.knots[h]}),a={u:o(0),v:o(1),weights:r.weights},l=new ml(r.id,r.model,a,r.rest_points,r.points,!1),c=r.rest_points.length===r.points.length&&l.takeNet(r.points,r.count[0],r.count[1],this.tick);return l.inside=s.get(r.id)??null,c||(l.fault=`the net of ${r.id} has not ${r.count[0]} × ${r.count[1]} points`),l}),this.tools=e.tools.map(r=>{let o={position:r.position,orientation:r.orientation},a=new gl(r.id,r.shape,r.radius,r.force_max,o),l=t.get(r.id);if(l===void 0)return a;let{holder:c,device:h,history:d,hand:u}=l;return Object.assign(a,{holder:c,device:h,history:d,hand:u})}),this.contacts=[],this.sceneVersion+=1,this.touch()}told=new Set;addEvent(e){let t=`${e.seq} ${e.tick} ${e.text}`;if(!this.told.has(t)){if(this.told.add(t),this.told.size>oy){for(let n of this.told)if(this.told.delete(n),this.told.size<=oy/2)break}this.joinOrPush(e),this.events.length>ry&&this.events.splice(0,this.events.length-ry),this.eventVersion+=1,this.touch()}}joinOrPush(e){let{repeated:t}=e;for(let n=this.events.length-1;t!==void 0&&n>=Math.max(0,this.events.length-fT);n--){let s=this.events[n];if(s.repeated===void 0)break;if(s.repeated.kind!==t.kind)continue;let r=s.repeated.count+t.count,o=s.repeated.worst>t.worst?s.repeated.worst:t.worst;this.events.splice(n,1),this.events.push({...e,text:t.words(r,o),repeated:{...t,count:r,worst:o}});return}this.events.push(e)}bounds(){let e=new ci;for(let s of this.bodies)e.take(s.rest);let t=e.size,n=e.empty?new ci:new ci().take(e.low).take(e.high);for(let s of this.tools)(!e.low.some((o,a)=>s.proxy[a]<o-t||s.proxy[a]>e.high[a]+t)||e.empty)&&n.take(s.proxy);return n}};var yl=class{constructor(e,t,n){this.recording=e;this.world=t;if(this.overview=new cu(e),this.at=e.firstTick,t.outlines=n,t.outlineVersion+=1,t.link="playing",e.snapshot!==null&&t.load(e.snapshot),t.name=e.scene,t.dt=e.dt,e.snapshot===null){let s={position:[0,0,0],orientation:[0,0,0,1]};t.tools=e.toolIds.map(r=>new gl(r,"sphere",0,0,s)),t.sceneVersion+=1}this.overview.fill()}recording;world;playing=!1;speed=1;loop=!1;seekMs=0;overview;at;shown=-1;busy=!1;wanted=null;eventsTold=-1;get first(){return this.recording.firstTick}get last(){return this.recording.lastTick}get tick(){return Math.round(this.at)}toggle(){!this.playing&&this.tick>=this.last&&(this.at=this.first),this.playing=!this.playing,this.world.touch()}step(e){this.playing=!1,this.seek(this.tick+e)}async seek(e){if(this.at=Math.min(Math.max(e,this.first),this.last),this.wanted=this.tick,!this.busy){this.busy=!0;try{for(;this.wanted!==null;){let t=this.wanted;this.wanted=null;let n=performance.now(),s=await this.recording.at(t);this.show(t,s),this.seekMs=performance.now()-n}}catch(t){this.world.trouble=`This place of the recording cannot be read: ${t instanceof Error?t.message:String(t)}`,this.world.touch()}finally{this.busy=!1}}}advance(e){this.tellEvents(),this.playing&&(this.at+=Math.min(e,250)*.001*this.speed/this.recording.dt,this.at>=this.last&&(this.loop?this.at=this.first:[this.at,this.playing]=[this.last,!1],this.world.touch())),this.tick!==this.shown&&!this.busy&&this.seek(this.at)}tellEvents(){let{overview:e,world:t}=this;e.version!==this.eventsTold&&(this.eventsTold=e.version,t.events=e.events.map(({tick:n,kind:s,detail:r},o)=>J0(n,s,r,o)),t.eventVersion+=1,t.historyVersion+=1,t.touch())}show(e,{tick:t,nets:n,hands:s}){let{world:r}=this;this.shown=e;for(let o of n.values()){let a=r.body(o.body);(a===void 0||!a.takeNet(o.points,o.countU,o.countV,o.tick))&&this.replaceBody(o)}for(let o of r.bodies)!n.has(o.id)&&o.netTick>e&&o.takeNet(o.rest,o.surface.u.count,o.surface.v.count,0);r.contacts=[],t?.tools.forEach(({values:o,contacts:a,contact:l,flags:c},h)=>{let d=r.tools[h];if(d===void 0||o.length<21)return;let u=y=>[o[y],o[y+1],o[y+2]];if(d.tick=t.tick,d.force=u(0),d.torque=u(3),d.proxy=u(6),d.orientation=[o[9],o[10],o[11],o[12]],d.contactForce=u(13),d.energy=o[19],d.dissipated=o[20],d.error=o[21]??0,d.flags=c,d.contacts=a,d.depth=l?.values[8]??0,d.hand=s[h]??null,l===null||!Il([...l.values]))return;let f=l.values,g=y=>[f[y],f[y+1],f[y+2]];r.contacts=[...r.contacts,{tool:d.id,body:this.recording.bodyIds[l.body]??"",u:f[0],v:f[1],point:g(2),normal:g(5),depth:f[8],force:g(9)}]}),r.tick=e,r.touch()}replaceBody(e){let{world:t}=this,n=(o,a)=>({degree:o,periodic:!1,count:a,knots:wm(o,a)}),s={u:n(e.degreeU,e.countU),v:n(e.degreeV,e.countV),weights:null},r=new ml(e.body,"",s,e.points,e.points,!0);r.netTick=e.tick,t.bodies=[...t.bodies.filter(({id:o})=>o!==e.body),r],t.sceneVersion+=1}stop(){this.overview.stop(),this.playing=!1}};var pT=8,mT=3,gT=700,yT=3e3,_T=.02,vT=.03;function xT(i){return{name:i,dof_force:0,dof_torque:0,workspace:[0,0,0],force_max:1e4,force_continuous:1e4,torque_max:1e4,mass:0,damping:0,coulomb_friction:0,encoder_resolution:0,rate_hz:60,delay_s:0,deadband:0}}var hu=class{constructor(e,t,n){this.world=e;this.daemon=t;this.sceneSize=n}world;daemon;sceneSize;state="free";tool=null;grip=!1;onEnd=()=>{};name=`mouse ${crypto.getRandomValues(new Uint16Array(1))[0].toString(16).padStart(4,"0")}`;confirmed=!1;claimed=0;moved=Ii;target=Ii;position=Ii;velocity=Ii;orientation=[0,0,0,1];seq=0n;last=0;relaxedSince=0;timer;get pose(){return{position:this.position,orientation:this.orientation}}take(e){if(this.daemon.mayWrite){if(this.state!=="free"){if(this.tool?.id===e.id){this.state="holding",this.target=this.position;return}this.end(null)}this.tool=e,this.state="holding",this.position=this.target=e.proxy,this.orientation=Ll(e.orientation),this.velocity=this.moved=Ii,this.seq=0n,this.grip=this.confirmed=!1,this.daemon.claim(e.id,xT(this.name)),this.last=this.claimed=performance.now(),this.timer=setInterval(()=>this.step(),pT),this.world.touch()}}move(e){this.state!=="holding"||!e.every(Number.isFinite)||(this.target=yi(this.target,e),this.confirmed||(this.moved=yi(this.moved,e)),performance.now()-this.last>=mT&&this.step())}turn(e,t){this.state==="holding"&&(this.orientation=Ll(qp($p(e,t),this.orientation)))}letGo(){this.state==="holding"&&(this.state="relaxing",this.grip=!1,this.relaxedSince=performance.now())}end(e){let{tool:t}=this;if(clearInterval(this.timer),t===null)return;let n=this.world.tool(t.id);n!==void 0&&(n.hand=null),e===null&&this.daemon.release(t.id),this.tool=null,this.state="free",this.world.touch(),this.onEnd(t.id,e)}step(){let e=performance.now(),t=Math.max((e-this.last)*.001,1e-4);if(this.tool===null)return;let n=this.world.tool(this.tool.id);if(n===void 0)return this.end("the tool is not in the scene any more");if(this.tool=n,this.state==="relaxing"){if(!this.confirmed)return this.end(null);if(this.target=n.proxy,e-this.relaxedSince>gT)return this.end(null)}let s=this.sceneSize(),r=Math.min((this.state==="relaxing"?2:15)*s,3);if(!this.confirmed)return this.confirmed=n.holder===this.name,!this.confirmed&&e-this.claimed>yT?this.end("the daemon did not answer"):this.confirmed?(this.position=n.proxy,this.target=yi(this.position,this.moved),this.send(e)):void 0;let o=(n.flags&en.WITHHELD)!==0,a=Wi(o?n.proxy:this.target,this.position),l=r*Math.min(t,vT),c=kt(a)>l?Ut(a,l/kt(a)):a;this.position=yi(this.position,c);let h=t/(t+_T);this.velocity=yi(Ut(this.velocity,1-h),Ut(c,h/t)),this.send(e)}send(e){let{tool:t}=this;t!==null&&(this.seq+=1n,this.last=e,t.hand=this.pose,this.daemon.pose(t.id,{seq:this.seq,t_client_ns:BigInt(Math.round(e*1e6)),position:this.position,orientation:this.orientation,linear_velocity:this.velocity,angular_velocity:Ii,buttons:this.grip?1:0,flags:0}),this.world.touch())}};var ay={mouse:14,pen:18,touch:34},uu=class{constructor(e,t,n){this.stage=e;this.hand=t;this.views=n;let{canvas:s}=e,r=s.parentElement??s;r.addEventListener("pointerdown",o=>this.down(o),{capture:!0}),r.addEventListener("pointermove",o=>this.move(o),{capture:!0});for(let o of["pointerup","pointercancel"])addEventListener(o,a=>this.up(a),{capture:!0});r.addEventListener("wheel",o=>this.wheel(o),{capture:!0,passive:!1}),s.addEventListener("contextmenu",o=>o.preventDefault())}stage;hand;views;onHover=()=>{};onTake=()=>{};enabled=()=>!0;caster=new Za;held=null;at={x:0,y:0};others=new Map;pick(e){let{canvas:t,camera:n}=this.stage,s=t.getBoundingClientRect(),[r,o]=[e.clientX-s.left,e.clientY-s.top],a=this.views().filter(d=>d.group.visible);this.caster.setFromCamera(new Ze(2*r/s.width-1,1-2*o/s.height),n);let l=this.caster.intersectObjects(a.map(d=>d.shape),!1)[0];if(l!==void 0)return a.find(d=>d.shape===l.object)??null;let c=null,h=ay[e.pointerType]??ay.mouse;for(let d of a){let u=this.stage.project(d.tool.proxy);if(u===null)continue;let f=Math.min(d.reach/u.metresPerPixel,60),g=Math.hypot(u.x-r,u.y-o)-f;g<h&&([c,h]=[d,g])}return c}down(e){if(e.target!==this.stage.canvas)return;if(this.held!==null){this.others.set(e.pointerId,e.clientY),e.stopPropagation();return}if(!this.enabled()||e.button>2||e.button===1)return;let t=this.pick(e);t!==null&&(e.stopPropagation(),e.preventDefault(),this.held=e.pointerId,this.at={x:e.clientX,y:e.clientY},this.stage.controls.enabled=!1,this.stage.canvas.setPointerCapture(e.pointerId),this.onTake(t.tool.id),this.hand.grip=e.shiftKey||e.button===2)}move(e){if(e.pointerId!==this.held){let a=this.others.get(e.pointerId);a!==void 0?(this.others.set(e.pointerId,e.clientY),this.push((a-e.clientY)/300),e.stopPropagation()):e.pointerType==="mouse"&&e.buttons===0&&e.target===this.stage.canvas&&this.onHover(this.enabled()?this.pick(e)?.tool.id??null:null);return}e.stopPropagation();let[t,n]=[e.clientX-this.at.x,e.clientY-this.at.y];this.at={x:e.clientX,y:e.clientY},this.hand.grip=e.shiftKey||(e.buttons&2)!==0;let{right:s,up:r}=this.stage.axes();if(e.ctrlKey||e.metaKey){this.hand.turn(r,t*.01),this.hand.turn(s,n*.01);return}let o=this.stage.project(this.hand.pose.position);o!==null&&this.hand.move(yi(Ut(s,t*o.metresPerPixel),Ut(r,-n*o.metresPerPixel)))}up(e){this.others.delete(e.pointerId),e.pointerId===this.held&&(this.held=null,this.others.clear(),this.stage.controls.enabled=!0,this.hand.letGo(),e.stopPropagation())}wheel(e){if(this.held===null)return;e.preventDefault(),e.stopPropagation();let t=e.deltaY*(e.deltaMode===1?16:e.deltaMode===2?400:1);this.push(-t/2500)}push(e){this.hand.move(Ut(this.stage.axes().away,e*this.stage.size))}drop(){this.held=null,this.stage.controls.enabled=!0}};var bT="uplot",ST="u-hz",MT="u-vt",wT="u-title",TT="u-wrap",ET="u-under",AT="u-over",RT="u-axis",Gr="u-off",CT="u-select",PT="u-cursor-x",IT="u-cursor-y",LT="u-cursor-pt",NT="u-legend",DT="u-live",FT="u-inline",UT="u-series",OT="u-marker",ly="u-label",kT="u-value",vl="width",xl="height";var cy="bottom",Xo="left",Gf="right",rp="#000",hy=rp+"0",Hf="mousemove",uy="mousedown",Wf="mouseup",dy="mouseenter",fy="mouseleave",py="dblclick",BT="resize",zT="scroll",my="change",gu="dppxchange",op="--",jo=typeof window<"u",Zf=jo?document:null,$o=jo?window:null,VT=jo?navigator:null,At,du;function Kf(){let i=devicePixelRatio;At!=i&&(At=i,du&&jf(my,du,Kf),du=matchMedia(`(min-resolution: ${At-.001}dppx) and (max-resolution: ${At+.001}dppx)`),Hr(my,du,Kf),$o.dispatchEvent(new CustomEvent(gu)))}function Ei(i,e){if(e!=null){let t=i.classList;!t.contains(e)&&t.add(e)}}function Jf(i,e){let t=i.classList;t.contains(e)&&t.remove(e)}function Kt(i,e,t){i.style[e]=t+"px"}function is(i,e,t,n){let s=Zf.createElement(i);return e!=null&&Ei(s,e),t?.insertBefore(s,n),s}function Bi(i,e){return is("div",i,e)}var gy=new WeakMap;function xs(i,e,t,n,s){let r="translate("+e+"px,"+t+"px)",o=gy.get(i);r!=o&&(i.style.transform=r,gy.set(i,r),e<0||t<0||e>n||t>s?Ei(i,Gr):Jf(i,Gr))}var yy=new WeakMap;function _y(i,e,t){let n=e+t,s=yy.get(i);n!=s&&(yy.set(i,n),i.style.background=e,i.style.borderColor=t)}var vy=new WeakMap;function xy(i,e,t,n){let s=e+""+t,r=vy.get(i);s!=r&&(vy.set(i,s),i.style.height=t+"px",i.style.width=e+"px",i.style.marginLeft=n?-e/2+"px":0,i.style.marginTop=n?-t/2+"px":0)}var ap={passive:!0},GT={...ap,capture:!0};function Hr(i,e,t,n){e.addEventListener(i,t,n?GT:ap)}function jf(i,e,t,n){e.removeEventListener(i,t,ap)}jo&&Kf();function ss(i,e,t,n){let s;t=t||0,n=n||e.length-1;let r=n<=2147483647;for(;n-t>1;)s=r?t+n>>1:Ai((t+n)/2),e[s]<i?t=s:n=s;return i-e[t]<=e[n]-i?t:n}function Yy(i){return(t,n,s)=>{let r=-1,o=-1;for(let a=n;a<=s;a++)if(i(t[a])){r=a;break}for(let a=s;a>=n;a--)if(i(t[a])){o=a;break}return[r,o]}}var Zy=i=>i!=null,Ky=i=>i!=null&&i>0,vu=Yy(Zy),HT=Yy(Ky);function WT(i,e,t,n=0,s=!1){let r=s?HT:vu,o=s?Ky:Zy;[e,t]=r(i,e,t);let a=i[e],l=i[e];if(e>-1)if(n==1)a=i[e],l=i[t];else if(n==-1)a=i[t],l=i[e];else for(let c=e;c<=t;c++){let h=i[c];o(h)&&(h<a?a=h:h>l&&(l=h))}return[a??zt,l??-zt]}function xu(i,e,t,n){let s=My(i),r=My(e);i==e&&(s==-1?(i*=t,e/=t):(i/=t,e*=t));let o=t==10?Gs:Jy,a=s==1?Ai:zi,l=r==1?zi:Ai,c=a(o(Nn(i))),h=l(o(Nn(e))),d=Yo(t,c),u=Yo(t,h);return t==10&&(c<0&&(d=Vt(d,-c)),h<0&&(u=Vt(u,-h))),n||t==2?(i=d*s,e=u*r):(i=t_(i,d),e=bu(e,u)),[i,e]}function lp(i,e,t,n){let s=xu(i,e,t,n);return i==0&&(s[0]=0),e==0&&(s[1]=0),s}var cp=.1,by={mode:3,pad:cp},Sl={pad:0,soft:null,mode:0},XT={min:Sl,max:Sl};function yu(i,e,t,n){return Su(t)?Sy(i,e,t):(Sl.pad=t,Sl.soft=n?0:null,Sl.mode=n?3:0,Sy(i,e,XT))}function wt(i,e){return i??e}function qT(i,e,t){for(e=wt(e,0),t=wt(t,i.length-1);e<=t;){if(i[e]!=null)return!0;e++}return!1}function Sy(i,e,t){let n=t.min,s=t.max,r=wt(n.pad,0),o=wt(s.pad,0),a=wt(n.hard,-zt),l=wt(s.hard,zt),c=wt(n.soft,zt),h=wt(s.soft,-zt),d=wt(n.mode,0),u=wt(s.mode,0),f=e-i,g=Gs(f),y=li(Nn(i),Nn(e)),p=Gs(y),m=Nn(p-g);(f<1e-24||m>10)&&(f=0,(i==0||e==0)&&(f=1e-24,d==2&&c!=zt&&(r=0),u==2&&h!=-zt&&(o=0)));let x=f||y||1e3,A=Gs(x),S=Yo(10,Ai(A)),R=x*(f==0?i==0?.1:1:r),M=Vt(t_(i-R,S/10),24),_=i>=c&&(d==1||d==3&&M<=c||d==2&&M>=c)?c:zt,E=li(a,M<_&&i>=_?_:rs(_,M)),k=x*(f==0?e==0?.1:1:o),N=Vt(bu(e+k,S/10),24),L=e<=h&&(u==1||u==3&&N>=h||u==2&&N<=h)?h:-zt,B=rs(l,N>L&&e<=L?L:li(L,N));return E==B&&E==0&&(B=100),[E,B]}var $T=new Intl.NumberFormat(jo?VT.language:"en-US"),hp=i=>$T.format(i),Ri=Math,mu=Ri.PI,Nn=Ri.abs,Ai=Ri.floor,Ln=Ri.round,zi=Ri.ceil,rs=Ri.min,li=Ri.max,Yo=Ri.pow,My=Ri.sign,Gs=Ri.log10,Jy=Ri.log2,YT=(i,e=1)=>Ri.sinh(i)*e,Xf=(i,e=1)=>Ri.asinh(i/e),zt=1/0;function wy(i){return(Gs((i^i>>31)-(i>>31))|0)+1}function Qf(i,e,t){return rs(li(i,e),t)}function jy(i){return typeof i=="function"}function xt(i){return jy(i)?i:()=>i}var ZT=()=>{},Qy=i=>i,e_=(i,e)=>e,KT=i=>null,Ty=i=>!0,Ey=(i,e)=>i==e,JT=/\.\d*?(?=9{6,}|0{6,})/gm,Wr=i=>{if(i_(i)||gr.has(i))return i;let e=`${i}`,t=e.match(JT);if(t==null)return i;let n=t[0].length-1;if(e.indexOf("e-")!=-1){let[s,r]=e.split("e");return+`${Wr(s)}e${r}`}return Vt(i,n)};function zr(i,e){return Wr(Vt(Wr(i/e))*e)}function bu(i,e){return Wr(zi(Wr(i/e))*e)}function t_(i,e){return Wr(Ai(Wr(i/e))*e)}function Vt(i,e=0){if(i_(i))return i;let t=10**e,n=i*t*(1+Number.EPSILON);return Ln(n)/t}var gr=new Map;function n_(i){return((""+i).split(".")[1]||"").length}function wl(i,e,t,n){let s=[],r=n.map(n_);for(let o=e;o<t;o++){let a=Nn(o),l=Vt(Yo(i,o),a);for(let c=0;c<n.length;c++){let h=i==10?+`${n[c]}e${o}`:n[c]*l,d=(o>=0?0:a)+(o>=r[c]?0:r[c]),u=i==10?h:Vt(h,d);s.push(u),gr.set(u,d)}}return s}var Ml={},up=[],Zo=[null,null],mr=Array.isArray,i_=Number.isInteger,jT=i=>i===void 0;function Ay(i){return typeof i=="string"}function Su(i){let e=!1;if(i!=null){let t=i.constructor;e=t==null||t==Object}return e}function QT(i){return i!=null&&typeof i=="object"}var eE=Object.getPrototypeOf(Uint8Array),s_="__proto__";function Ko(i,e=Su){let t;if(mr(i)){let n=i.find(s=>s!=null);if(mr(n)||e(n)){t=Array(i.length);for(let s=0;s<i.length;s++)t[s]=Ko(i[s],e)}else t=i.slice()}else if(i instanceof eE)t=i.slice();else if(e(i)){t={};for(let n in i)n!=s_&&(t[n]=Ko(i[n],e))}else t=i;return t}function wn(i){let e=arguments;for(let t=1;t<e.length;t++){let n=e[t];for(let s in n)s!=s_&&(Su(i[s])?wn(i[s],Ko(n[s])):i[s]=Ko(n[s]))}return i}var tE=0,nE=1,iE=2;function sE(i,e,t){for(let n=0,s,r=-1;n<e.length;n++){let o=e[n];if(o>r){for(s=o-1;s>=0&&i[s]==null;)i[s--]=null;for(s=o+1;s<t&&i[s]==null;)i[r=s++]=null}}}function rE(i,e){if(lE(i)){let o=i[0].slice();for(let a=1;a<i.length;a++)o.push(...i[a].slice(1));return cE(o[0])||(o=aE(o)),o}let t=new Set;for(let o=0;o<i.length;o++){let l=i[o][0],c=l.length;for(let h=0;h<c;h++)t.add(l[h])}let n=[Array.from(t).sort((o,a)=>o-a)],s=n[0].length,r=new Map;for(let o=0;o<s;o++)r.set(n[0][o],o);for(let o=0;o<i.length;o++){let a=i[o],l=a[0];for(let c=1;c<a.length;c++){let h=a[c],d=Array(s).fill(void 0),u=e?e[o][c]:nE,f=[];for(let g=0;g<h.length;g++){let y=h[g],p=r.get(l[g]);y===null?u!=tE&&(d[p]=y,u==iE&&f.push(p)):d[p]=y}sE(d,f,s),n.push(d)}}return n}var oE=typeof queueMicrotask>"u"?i=>Promise.resolve().then(i):queueMicrotask;function aE(i){let e=i[0],t=e.length,n=Array(t);for(let r=0;r<n.length;r++)n[r]=r;n.sort((r,o)=>e[r]-e[o]);let s=[];for(let r=0;r<i.length;r++){let o=i[r],a=Array(t);for(let l=0;l<t;l++)a[l]=o[n[l]];s.push(a)}return s}function lE(i){let e=i[0][0],t=e.length;for(let n=1;n<i.length;n++){let s=i[n][0];if(s.length!=t)return!1;if(s!=e){for(let r=0;r<t;r++)if(s[r]!=e[r])return!1}}return!0}function cE(i,e=100){let t=i.length;if(t<=1)return!0;let n=0,s=t-1;for(;n<=s&&i[n]==null;)n++;for(;s>=n&&i[s]==null;)s--;if(s<=n)return!0;let r=li(1,Ai((s-n+1)/e));for(let o=i[n],a=n+r;a<=s;a+=r){let l=i[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var r_=["January","February","March","April","May","June","July","August","September","October","November","December"],o_=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function a_(i){return i.slice(0,3)}var hE=o_.map(a_),uE=r_.map(a_),dE={MMMM:r_,MMM:uE,WWWW:o_,WWW:hE};function _l(i){return(i<10?"0":"")+i}function fE(i){return(i<10?"00":i<100?"0":"")+i}var pE={YYYY:i=>i.getFullYear(),YY:i=>(i.getFullYear()+"").slice(2),MMMM:(i,e)=>e.MMMM[i.getMonth()],MMM:(i,e)=>e.MMM[i.getMonth()],MM:i=>_l(i.getMonth()+1),M:i=>i.getMonth()+1,DD:i=>_l(i.getDate()),D:i=>i.getDate(),WWWW:(i,e)=>e.WWWW[i.getDay()],WWW:(i,e)=>e.WWW[i.getDay()],HH:i=>_l(i.getHours()),H:i=>i.getHours(),h:i=>{let e=i.getHours();return e==0?12:e>12?e-12:e},AA:i=>i.getHours()>=12?"PM":"AM",aa:i=>i.getHours()>=12?"pm":"am",a:i=>i.getHours()>=12?"p":"a",mm:i=>_l(i.getMinutes()),m:i=>i.getMinutes(),ss:i=>_l(i.getSeconds()),s:i=>i.getSeconds(),fff:i=>fE(i.getMilliseconds())};function dp(i,e){e=e||dE;let t=[],n=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=n.exec(i);)t.push(s[0][0]=="{"?pE[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<t.length;a++)o+=typeof t[a]=="string"?t[a]:t[a](r,e);return o}}var mE=new Intl.DateTimeFormat().resolvedOptions().timeZone;function gE(i,e){let t;return e=="UTC"||e=="Etc/UTC"?t=new Date(+i+i.getTimezoneOffset()*6e4):e==mE?t=i:(t=new Date(i.toLocaleString("en-US",{timeZone:e})),t.setMilliseconds(i.getMilliseconds())),t}var l_=i=>i%1==0,_u=[1,2,2.5,5],yE=wl(10,-32,0,_u),c_=wl(10,0,32,_u),_E=c_.filter(l_),Vr=yE.concat(c_),fp=`
`,h_="{YYYY}",Ry=fp+h_,u_="{M}/{D}",bl=fp+u_,fu=bl+"/{YY}",d_="{aa}",vE="{h}:{mm}",qo=vE+d_,Cy=fp+qo,Py=":{ss}",Pt=null;function f_(i){let e=i*1e3,t=e*60,n=t*60,s=n*24,r=s*30,o=s*365,l=(i==1?wl(10,0,3,_u).filter(l_):wl(10,-3,0,_u)).concat([e,e*5,e*10,e*15,e*30,t,t*5,t*10,t*15,t*30,n,n*2,n*3,n*4,n*6,n*8,n*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,h_,Pt,Pt,Pt,Pt,Pt,Pt,1],[s*28,"{MMM}",Ry,Pt,Pt,Pt,Pt,Pt,1],[s,u_,Ry,Pt,Pt,Pt,Pt,Pt,1],[n,"{h}"+d_,fu,Pt,bl,Pt,Pt,Pt,1],[t,qo,fu,Pt,bl,Pt,Pt,Pt,1],[e,Py,fu+" "+qo,Pt,bl+" "+qo,Pt,Cy,Pt,1],[i,Py+".{fff}",fu+" "+qo,Pt,bl+" "+qo,Pt,Cy,Pt,1]];function h(d){return(u,f,g,y,p,m)=>{let x=[],A=p>=o,S=p>=r&&p<o,R=d(g),M=Vt(R*i,3),_=qf(R.getFullYear(),A?0:R.getMonth(),S||A?1:R.getDate()),E=Vt(_*i,3);if(S||A){let k=S?p/r:0,N=A?p/o:0,L=M==E?M:Vt(qf(_.getFullYear()+N,_.getMonth()+k,1)*i,3),B=new Date(Ln(L/i)),V=B.getFullYear(),P=B.getMonth();for(let F=0;L<=y;F++){let X=qf(V+N*F,P+k*F,1),G=X-d(Vt(X*i,3));L=Vt((+X+G)*i,3),L<=y&&x.push(L)}}else{let k=p>=s?s:p,N=Ai(g)-Ai(M),L=E+N+bu(M-E,k);x.push(L);let B=d(L),V=B.getHours()+B.getMinutes()/t+B.getSeconds()/n,P=p/n,F=u.axes[f]._space,X=m/F;for(;L=Vt(L+p,i==1?0:3),!(L>y);)if(P>1){let G=Ai(Vt(V+P,6))%24,J=d(L).getHours()-G;J>1&&(J=-1),L-=J*n,V=(V+P)%24;let ne=x[x.length-1];Vt((L-ne)/p,3)*X>=.7&&x.push(L)}else x.push(L)}return x}}return[l,c,h]}var[xE,bE,SE]=f_(1),[ME,wE,TE]=f_(.001);wl(2,-53,53,[1]);function Iy(i,e){return i.map(t=>t.map((n,s)=>s==0||s==8||n==null?n:e(s==1||t[8]==0?n:t[1]+n)))}function Ly(i,e){return(t,n,s,r,o)=>{let a=e.find(g=>o>=g[0])||e[e.length-1],l,c,h,d,u,f;return n.map(g=>{let y=i(g),p=y.getFullYear(),m=y.getMonth(),x=y.getDate(),A=y.getHours(),S=y.getMinutes(),R=y.getSeconds(),M=p!=l&&a[2]||m!=c&&a[3]||x!=h&&a[4]||A!=d&&a[5]||S!=u&&a[6]||R!=f&&a[7]||a[1];return l=p,c=m,h=x,d=A,u=S,f=R,M(y)})}}function EE(i,e){let t=dp(e);return(n,s,r,o,a)=>s.map(l=>t(i(l)))}function qf(i,e,t){return new Date(i,e,t)}function Ny(i,e){return e(i)}var AE="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function Dy(i,e){return(t,n,s,r)=>r==null?op:e(i(n))}function RE(i,e){let t=i.series[e];return t.width?t.stroke(i,e):t.points.width?t.points.stroke(i,e):null}function CE(i,e){return i.series[e].fill(i,e)}var PE={show:!0,live:!0,isolate:!1,mount:ZT,markers:{show:!0,width:2,stroke:RE,fill:CE,dash:"solid"},idx:null,idxs:null,values:[]};function IE(i,e){let t=i.cursor.points,n=Bi(),s=t.size(i,e);Kt(n,vl,s),Kt(n,xl,s);let r=s/-2;Kt(n,"marginLeft",r),Kt(n,"marginTop",r);let o=t.width(i,e,s);return o&&Kt(n,"borderWidth",o),n}function LE(i,e){let t=i.series[e].points;return t._fill||t._stroke}function NE(i,e){let t=i.series[e].points;return t._stroke||t._fill}function DE(i,e){return i.series[e].points.size}var $f=[0,0];function FE(i,e,t){return $f[0]=e,$f[1]=t,$f}function pu(i,e,t,n=!0){return s=>{s.button==0&&(!n||s.target==e)&&t(s)}}function Yf(i,e,t,n=!0){return s=>{(!n||s.target==e)&&t(s)}}var UE={show:!0,x:!0,y:!0,lock:!1,move:FE,points:{one:!1,show:IE,size:DE,width:0,stroke:NE,fill:LE},bind:{mousedown:pu,mouseup:pu,click:pu,dblclick:pu,mousemove:Yf,mouseleave:Yf,mouseenter:Yf},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(i,e)=>{e.stopPropagation(),e.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(i,e,t,n,s)=>n-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},p_={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},pp=wn({},p_,{filter:e_}),m_=wn({},pp,{size:10}),g_=wn({},p_,{show:!1}),mp='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',y_="bold "+mp,__=1.5,Fy={show:!0,scale:"x",stroke:rp,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:y_,side:2,grid:pp,ticks:m_,border:g_,font:mp,lineGap:__,rotate:0},OE="Value",kE="Time",Uy={show:!0,scale:"x",auto:!1,sorted:1,min:zt,max:-zt,idxs:[]};function BE(i,e,t,n,s){return e.map(r=>r==null?"":hp(r))}function zE(i,e,t,n,s,r,o){let a=[],l=gr.get(s)||0;t=o?t:Vt(bu(t,s),l);for(let c=t;c<=n;c=Vt(c+s,l))a.push(Object.is(c,-0)?0:c);return a}function ep(i,e,t,n,s,r,o){let a=[],l=i.scales[i.axes[e].scale].log,c=l==10?Gs:Jy,h=Ai(c(t));s=Yo(l,h),l==10&&(s=Vr[ss(s,Vr)]);let d=t,u=s*l;l==10&&(u=Vr[ss(u,Vr)]);do a.push(d),d=d+s,l==10&&!gr.has(d)&&(d=Vt(d,gr.get(s))),d>=u&&(s=d,u=s*l,l==10&&(u=Vr[ss(u,Vr)]));while(d<=n);return a}function VE(i,e,t,n,s,r,o){let l=i.scales[i.axes[e].scale].asinh,c=n>l?ep(i,e,li(l,t),n,s):[l],h=n>=0&&t<=0?[0]:[];return(t<-l?ep(i,e,li(l,-n),-t,s):[l]).reverse().map(u=>-u).concat(h,c)}var v_=/./,GE=/[12357]/,HE=/[125]/,Oy=/1/,tp=(i,e,t,n)=>i.map((s,r)=>e==4&&s==0||r%n==0&&t.test(s.toExponential()[s<0?1:0])?s:null);function WE(i,e,t,n,s){let r=i.axes[t],o=r.scale,a=i.scales[o],l=i.valToPos,c=r._space,h=l(10,o),d=l(9,o)-h>=c?v_:l(7,o)-h>=c?GE:l(5,o)-h>=c?HE:Oy;if(d==Oy){let u=Nn(l(1,o)-h);if(u<c)return tp(e.slice().reverse(),a.distr,d,zi(c/u)).reverse()}return tp(e,a.distr,d,1)}function XE(i,e,t,n,s){let r=i.axes[t],o=r.scale,a=r._space,l=i.valToPos,c=Nn(l(1,o)-l(2,o));return c<a?tp(e.slice().reverse(),3,v_,zi(a/c)).reverse():e}function qE(i,e,t,n){return n==null?op:e==null?"":hp(e)}var ky={show:!0,scale:"y",stroke:rp,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:y_,side:3,grid:pp,ticks:m_,border:g_,font:mp,lineGap:__,rotate:0};function $E(i,e){let t=3+(i||1)*2;return Vt(t*e,3)}function YE(i,e){let{scale:t,idxs:n}=i.series[0],s=i._data[0],r=i.valToPos(s[n[0]],t,!0),o=i.valToPos(s[n[1]],t,!0),a=Nn(o-r),l=i.series[e],c=a/(l.points.space*At);return n[1]-n[0]<=c}var By={scale:null,auto:!0,sorted:0,min:zt,max:-zt},x_=(i,e,t,n,s)=>s,zy={show:!0,auto:!0,sorted:0,gaps:x_,alpha:1,facets:[wn({},By,{scale:"x"}),wn({},By,{scale:"y"})]},Vy={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:x_,alpha:1,points:{show:YE,filter:null},values:null,min:zt,max:-zt,idxs:[],path:null,clip:null};function ZE(i,e,t,n,s){return t/10}var b_={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},KE=wn({},b_,{time:!1,ori:1}),Gy={};function S_(i,e){let t=Gy[i];return t||(t={key:i,plots:[],sub(n){t.plots.push(n)},unsub(n){t.plots=t.plots.filter(s=>s!=n)},pub(n,s,r,o,a,l,c){for(let h=0;h<t.plots.length;h++)t.plots[h]!=s&&t.plots[h].pub(n,s,r,o,a,l,c)}},i!=null&&(Gy[i]=t)),t}var Jo=1,np=2;function Xr(i,e,t){let n=i.mode,s=i.series[e],r=n==2?i._data[e]:i._data,o=i.scales,a=i.bbox,l=r[0],c=n==2?r[1]:r[e],h=n==2?o[s.facets[0].scale]:o[i.series[0].scale],d=n==2?o[s.facets[1].scale]:o[s.scale],u=a.left,f=a.top,g=a.width,y=a.height,p=i.valToPosH,m=i.valToPosV;return h.ori==0?t(s,l,c,h,d,p,m,u,f,g,y,wu,Qo,Eu,w_,E_):t(s,l,c,h,d,m,p,f,u,y,g,Tu,ea,_p,T_,A_)}function gp(i,e){let t=0,n=0,s=wt(i.bands,up);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==e?t=o.dir:o.series[1]==e&&(o.dir==1?n|=1:n|=2)}return[t,n==1?-1:n==2?1:n==3?2:0]}function JE(i,e,t,n,s){let r=i.mode,o=i.series[e],a=r==2?o.facets[1].scale:o.scale,l=i.scales[a];return s==-1?l.min:s==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function Hs(i,e,t,n,s,r){return Xr(i,e,(o,a,l,c,h,d,u,f,g,y,p)=>{let m=o.pxRound,x=c.dir*(c.ori==0?1:-1),A=c.ori==0?Qo:ea,S,R;x==1?(S=t,R=n):(S=n,R=t);let M=m(d(a[S],c,y,f)),_=m(u(l[S],h,p,g)),E=m(d(a[R],c,y,f)),k=m(u(r==1?h.max:h.min,h,p,g)),N=new Path2D(s);return A(N,E,k),A(N,M,k),A(N,M,_),N})}function Mu(i,e,t,n,s,r){let o=null;if(i.length>0){o=new Path2D;let a=e==0?Eu:_p,l=t;for(let d=0;d<i.length;d++){let u=i[d];if(u[1]>u[0]){let f=u[0]-l;f>0&&a(o,l,n,f,n+r),l=u[1]}}let c=t+s-l,h=10;c>0&&a(o,l,n-h/2,c,n+r+h)}return o}function jE(i,e,t){let n=i[i.length-1];n&&n[0]==e?n[1]=t:i.push([e,t])}function yp(i,e,t,n,s,r,o){let a=[],l=i.length;for(let c=s==1?t:n;c>=t&&c<=n;c+=s)if(e[c]===null){let d=c,u=c;if(s==1)for(;++c<=n&&e[c]===null;)u=c;else for(;--c>=t&&e[c]===null;)u=c;let f=r(i[d]),g=u==d?f:r(i[u]),y=d-s;f=o<=0&&y>=0&&y<l?r(i[y]):f;let m=u+s;g=o>=0&&m>=0&&m<l?r(i[m]):g,g>=f&&a.push([f,g])}return a}function Hy(i){return i==0?Qy:i==1?Ln:e=>zr(e,i)}function M_(i){let e=i==0?wu:Tu,t=i==0?(s,r,o,a,l,c)=>{s.arcTo(r,o,a,l,c)}:(s,r,o,a,l,c)=>{s.arcTo(o,r,l,a,c)},n=i==0?(s,r,o,a,l)=>{s.rect(r,o,a,l)}:(s,r,o,a,l)=>{s.rect(o,r,l,a)};return(s,r,o,a,l,c=0,h=0)=>{c==0&&h==0?n(s,r,o,a,l):(c=rs(c,a/2,l/2),h=rs(h,a/2,l/2),e(s,r+c,o),t(s,r+a,o,r+a,o+l,c),t(s,r+a,o+l,r,o+l,h),t(s,r,o+l,r,o,h),t(s,r,o,r+a,o,c),s.closePath())}}var wu=(i,e,t)=>{i.moveTo(e,t)},Tu=(i,e,t)=>{i.moveTo(t,e)},Qo=(i,e,t)=>{i.lineTo(e,t)},ea=(i,e,t)=>{i.lineTo(t,e)},Eu=M_(0),_p=M_(1),w_=(i,e,t,n,s,r)=>{i.arc(e,t,n,s,r)},T_=(i,e,t,n,s,r)=>{i.arc(t,e,n,s,r)},E_=(i,e,t,n,s,r,o)=>{i.bezierCurveTo(e,t,n,s,r,o)},A_=(i,e,t,n,s,r,o)=>{i.bezierCurveTo(t,e,s,n,o,r)};function R_(i){return(e,t,n,s,r)=>Xr(e,t,(o,a,l,c,h,d,u,f,g,y,p)=>{let{pxRound:m,points:x}=o,A,S;c.ori==0?(A=wu,S=w_):(A=Tu,S=T_);let R=Vt(x.width*At,3),M=(x.size-x.width)/2*At,_=Vt(M*2,3),E=new Path2D,k=new Path2D,{left:N,top:L,width:B,height:V}=e.bbox;Eu(k,N-_,L-_,B+_*2,V+_*2);let P=F=>{if(l[F]!=null){let X=m(d(a[F],c,y,f)),G=m(u(l[F],h,p,g));A(E,X+M,G),S(E,X,G,M,0,mu*2)}};if(r)r.forEach(P);else for(let F=n;F<=s;F++)P(F);return{stroke:R>0?E:null,fill:E,clip:k,flags:Jo|np}})}function C_(i){return(e,t,n,s,r,o)=>{n!=s&&(r!=n&&o!=n&&i(e,t,n),r!=s&&o!=s&&i(e,t,s),i(e,t,o))}}var QE=C_(Qo),eA=C_(ea);function P_(i){let e=wt(i?.alignGaps,0);return(t,n,s,r)=>Xr(t,n,(o,a,l,c,h,d,u,f,g,y,p)=>{[s,r]=vu(l,s,r);let m=o.pxRound,x=V=>m(d(V,c,y,f)),A=V=>m(u(V,h,p,g)),S,R;c.ori==0?(S=Qo,R=QE):(S=ea,R=eA);let M=c.dir*(c.ori==0?1:-1),_={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Jo},E=_.stroke,k=!1;if(r-s>=y*4){let V=ce=>t.posToVal(ce,c.key,!0),P=null,F=null,X,G,oe,$=x(a[M==1?s:r]),J=x(a[s]),ne=x(a[r]),ue=V(M==1?J+1:ne-1);for(let ce=M==1?s:r;ce>=s&&ce<=r;ce+=M){let Q=a[ce],me=(M==1?Q<ue:Q>ue)?$:x(Q),ye=l[ce];me==$?ye!=null?(G=ye,P==null?(S(E,me,A(G)),X=P=F=G):G<P?P=G:G>F&&(F=G)):ye===null&&(k=!0):(P!=null&&R(E,$,A(P),A(F),A(X),A(G)),ye!=null?(G=ye,S(E,me,A(G)),P=F=X=G):(P=F=null,ye===null&&(k=!0)),$=me,ue=V($+M))}P!=null&&P!=F&&oe!=$&&R(E,$,A(P),A(F),A(X),A(G))}else for(let V=M==1?s:r;V>=s&&V<=r;V+=M){let P=l[V];P===null?k=!0:P!=null&&S(E,x(a[V]),A(P))}let[L,B]=gp(t,n);if(o.fill!=null||L!=0){let V=_.fill=new Path2D(E),P=o.fillTo(t,n,o.min,o.max,L),F=A(P),X=x(a[s]),G=x(a[r]);M==-1&&([G,X]=[X,G]),S(V,G,F),S(V,X,F)}if(!o.spanGaps){let V=[];k&&V.push(...yp(a,l,s,r,M,x,e)),_.gaps=V=o.gaps(t,n,s,r,V),_.clip=Mu(V,c.ori,f,g,y,p)}return B!=0&&(_.band=B==2?[Hs(t,n,s,r,E,-1),Hs(t,n,s,r,E,1)]:Hs(t,n,s,r,E,B)),_})}function tA(i){let e=wt(i.align,1),t=wt(i.ascDesc,!1),n=wt(i.alignGaps,0),s=wt(i.extend,!1);return(r,o,a,l)=>Xr(r,o,(c,h,d,u,f,g,y,p,m,x,A)=>{[a,l]=vu(d,a,l);let S=c.pxRound,{left:R,width:M}=r.bbox,_=J=>S(g(J,u,x,p)),E=J=>S(y(J,f,A,m)),k=u.ori==0?Qo:ea,N={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Jo},L=N.stroke,B=u.dir*(u.ori==0?1:-1),V=E(d[B==1?a:l]),P=_(h[B==1?a:l]),F=P,X=P;s&&e==-1&&(X=R,k(L,X,V)),k(L,P,V);for(let J=B==1?a:l;J>=a&&J<=l;J+=B){let ne=d[J];if(ne==null)continue;let ue=_(h[J]),ce=E(ne);e==1?k(L,ue,V):k(L,F,ce),k(L,ue,ce),V=ce,F=ue}let G=F;s&&e==1&&(G=R+M,k(L,G,V));let[oe,$]=gp(r,o);if(c.fill!=null||oe!=0){let J=N.fill=new Path2D(L),ne=c.fillTo(r,o,c.min,c.max,oe),ue=E(ne);k(J,G,ue),k(J,X,ue)}if(!c.spanGaps){let J=[];J.push(...yp(h,d,a,l,B,_,n));let ne=c.width*At/2,ue=t||e==1?ne:-ne,ce=t||e==-1?-ne:ne;J.forEach(Q=>{Q[0]+=ue,Q[1]+=ce}),N.gaps=J=c.gaps(r,o,a,l,J),N.clip=Mu(J,u.ori,p,m,x,A)}return $!=0&&(N.band=$==2?[Hs(r,o,a,l,L,-1),Hs(r,o,a,l,L,1)]:Hs(r,o,a,l,L,$)),N})}function Wy(i,e,t,n,s,r,o=zt){if(i.length>1){let a=null;for(let l=0,c=1/0;l<i.length;l++)if(e[l]!==void 0){if(a!=null){let h=Nn(i[l]-i[a]);h<c&&(c=h,o=Nn(t(i[l],n,s,r)-t(i[a],n,s,r)))}a=l}}return o}function nA(i){i=i||Ml;let e=wt(i.size,[.6,zt,1]),t=i.align||0,n=i.gap||0,s=i.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=xt(s),o=1-e[0],a=wt(e[1],zt),l=wt(e[2],1),c=wt(i.disp,Ml),h=wt(i.each,f=>{}),{fill:d,stroke:u}=c;return(f,g,y,p)=>Xr(f,g,(m,x,A,S,R,M,_,E,k,N,L)=>{let B=m.pxRound,V=t,P=n*At,F=a*At,X=l*At,G,oe;S.ori==0?[G,oe]=r(f,g):[oe,G]=r(f,g);let $=S.dir*(S.ori==0?1:-1),J=S.ori==0?Eu:_p,ne=S.ori==0?h:(Ce,Ke,lt,we,Ot,Ge,qe)=>{h(Ce,Ke,lt,Ot,we,qe,Ge)},ue=wt(f.bands,up).find(Ce=>Ce.series[0]==g),ce=ue!=null?ue.dir:0,Q=m.fillTo(f,g,m.min,m.max,ce),pe=B(_(Q,R,L,k)),me,ye,ge,Ve=N,Je=B(m.width*At),Ue=!1,rt=null,ct=null,ot=null,jt=null;d!=null&&(Je==0||u!=null)&&(Ue=!0,rt=d.values(f,g,y,p),ct=new Map,new Set(rt).forEach(Ce=>{Ce!=null&&ct.set(Ce,new Path2D)}),Je>0&&(ot=u.values(f,g,y,p),jt=new Map,new Set(ot).forEach(Ce=>{Ce!=null&&jt.set(Ce,new Path2D)})));let{x0:Gt,size:pn}=c;if(Gt!=null&&pn!=null){V=1,x=Gt.values(f,g,y,p),Gt.unit==2&&(x=x.map(lt=>f.posToVal(E+lt*N,S.key,!0)));let Ce=pn.values(f,g,y,p);pn.unit==2?ye=Ce[0]*N:ye=M(Ce[0],S,N,E)-M(0,S,N,E),Ve=Wy(x,A,M,S,N,E,Ve),ge=Ve-ye+P}else Ve=Wy(x,A,M,S,N,E,Ve),ge=Ve*o+P,ye=Ve-ge;ge<1&&(ge=0),Je>=ye/2&&(Je=0),ge<5&&(B=Qy);let Dt=ge>0,Dn=Ve-ge-(Dt?Je:0);ye=B(Qf(Dn,X,F)),me=(V==0?ye/2:V==$?0:ye)-V*$*((V==0?P/2:0)+(Dt?Je/2:0));let bt={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},Tn=Ue?null:new Path2D,rn=null;if(ue!=null)rn=f.data[ue.series[1]];else{let{y0:Ce,y1:Ke}=c;Ce!=null&&Ke!=null&&(A=Ke.values(f,g,y,p),rn=Ce.values(f,g,y,p))}let mn=G*ye,O=oe*ye;for(let Ce=$==1?y:p;Ce>=y&&Ce<=p;Ce+=$){let Ke=A[Ce];if(Ke==null)continue;if(rn!=null){let q=rn[Ce]??0;if(Ke-q==0)continue;pe=_(q,R,L,k)}let lt=S.distr!=2||c!=null?x[Ce]:Ce,we=M(lt,S,N,E),Ot=_(wt(Ke,Q),R,L,k),Ge=B(we-me),qe=B(li(Ot,pe)),C=B(rs(Ot,pe)),b=qe-C;if(Ke!=null){let q=Ke<0?O:mn,he=Ke<0?mn:O;Ue?(Je>0&&ot[Ce]!=null&&J(jt.get(ot[Ce]),Ge,C+Ai(Je/2),ye,li(0,b-Je),q,he),rt[Ce]!=null&&J(ct.get(rt[Ce]),Ge,C+Ai(Je/2),ye,li(0,b-Je),q,he)):J(Tn,Ge,C+Ai(Je/2),ye,li(0,b-Je),q,he),ne(f,g,Ce,Ge-Je/2,C,ye+Je,b)}}return Je>0?bt.stroke=Ue?jt:Tn:Ue||(bt._fill=m.width==0?m._fill:m._stroke??m._fill,bt.width=0),bt.fill=Ue?ct:Tn,bt})}function iA(i,e){let t=wt(e?.alignGaps,0);return(n,s,r,o)=>Xr(n,s,(a,l,c,h,d,u,f,g,y,p,m)=>{[r,o]=vu(c,r,o);let x=a.pxRound,A=G=>x(u(G,h,p,g)),S=G=>x(f(G,d,m,y)),R,M,_;h.ori==0?(R=wu,_=Qo,M=E_):(R=Tu,_=ea,M=A_);let E=h.dir*(h.ori==0?1:-1),k=A(l[E==1?r:o]),N=k,L=[],B=[];for(let G=E==1?r:o;G>=r&&G<=o;G+=E)if(c[G]!=null){let $=l[G],J=A($);L.push(N=J),B.push(S(c[G]))}let V={stroke:i(L,B,R,_,M,x),fill:null,clip:null,band:null,gaps:null,flags:Jo},P=V.stroke,[F,X]=gp(n,s);if(a.fill!=null||F!=0){let G=V.fill=new Path2D(P),oe=a.fillTo(n,s,a.min,a.max,F),$=S(oe);_(G,N,$),_(G,k,$)}if(!a.spanGaps){let G=[];G.push(...yp(l,c,r,o,E,A,t)),V.gaps=G=a.gaps(n,s,r,o,G),V.clip=Mu(G,h.ori,g,y,p,m)}return X!=0&&(V.band=X==2?[Hs(n,s,r,o,P,-1),Hs(n,s,r,o,P,1)]:Hs(n,s,r,o,P,X)),V})}function sA(i){return iA(rA,i)}function rA(i,e,t,n,s,r){let o=i.length;if(o<2)return null;let a=new Path2D;if(t(a,i[0],e[0]),o==2)n(a,i[1],e[1]);else{let l=Array(o),c=Array(o-1),h=Array(o-1),d=Array(o-1);for(let u=0;u<o-1;u++)h[u]=e[u+1]-e[u],d[u]=i[u+1]-i[u],c[u]=h[u]/d[u];l[0]=c[0];for(let u=1;u<o-1;u++)c[u]===0||c[u-1]===0||c[u-1]>0!=c[u]>0?l[u]=0:(l[u]=3*(d[u-1]+d[u])/((2*d[u]+d[u-1])/c[u-1]+(d[u]+2*d[u-1])/c[u]),isFinite(l[u])||(l[u]=0));l[o-1]=c[o-2];for(let u=0;u<o-1;u++)s(a,i[u]+d[u]/3,e[u]+l[u]*d[u]/3,i[u+1]-d[u]/3,e[u+1]-l[u+1]*d[u]/3,i[u+1],e[u+1])}return a}var ip=new Set;function Xy(){for(let i of ip)i.syncRect(!0)}jo&&(Hr(BT,$o,Xy),Hr(zT,$o,Xy,!0),Hr(gu,$o,()=>{Xn.pxRatio=At}));var oA=P_(),aA=R_();function qy(i,e,t,n){return(n?[i[0],i[1]].concat(i.slice(2)):[i[0]].concat(i.slice(1))).map((r,o)=>sp(r,o,e,t))}function lA(i,e){return i.map((t,n)=>n==0?{}:wn({},e,t))}function sp(i,e,t,n){return wn({},e==0?t:n,i)}function I_(i,e,t){return e==null?Zo:[e,t]}var cA=I_;function hA(i,e,t){return e==null?Zo:yu(e,t,cp,!0)}function L_(i,e,t,n){return e==null?Zo:xu(e,t,i.scales[n].log,!1)}var uA=L_;function N_(i,e,t,n){return e==null?Zo:lp(e,t,i.scales[n].log,!1)}var dA=N_;function fA(i,e,t,n,s){let r=li(wy(i),wy(e)),o=e-i,a=ss(s/n*o,t);do{let l=t[a],c=n*l/o;if(c>=s&&r+(l<5?gr.get(l):0)<=17)return[l,c]}while(++a<t.length);return[0,0]}function $y(i){let e,t;return i=i.replace(/(\d+)px/,(n,s)=>(e=Ln((t=+s)*At))+"px"),[i,e,t]}function pA(i){i.show&&[i.font,i.labelFont].forEach(e=>{let t=Vt(e[2]*At,1);e[0]=e[0].replace(/[0-9.]+px/,t+"px"),e[1]=t})}function Xn(i,e,t){let n={mode:wt(i.mode,1)},s=n.mode;function r(v,w,I,D){let H=w.valToPct(v);return D+I*(w.dir==-1?1-H:H)}function o(v,w,I,D){let H=w.valToPct(v);return D+I*(w.dir==-1?H:1-H)}function a(v,w,I,D){return w.ori==0?r(v,w,I,D):o(v,w,I,D)}n.valToPosH=r,n.valToPosV=o;let l=!1;n.status=0;let c=n.root=Bi(bT);if(i.id!=null&&(c.id=i.id),Ei(c,i.class),i.title){let v=Bi(wT,c);v.textContent=i.title}let h=is("canvas"),d=n.ctx=h.getContext("2d"),u=Bi(TT,c);Hr("click",u,v=>{v.target===g&&(Xt!=jr||Qt!=Qr)&&Hn.click(n,v)},!0);let f=n.under=Bi(ET,u);u.appendChild(h);let g=n.over=Bi(AT,u);i=Ko(i);let y=+wt(i.pxAlign,1),p=Hy(y);(i.plugins||[]).forEach(v=>{v.opts&&(i=v.opts(n,i)||i)});let m=i.ms||.001,x=n.series=s==1?qy(i.series||[],Uy,Vy,!1):lA(i.series||[null],zy),A=n.axes=qy(i.axes||[],Fy,ky,!0),S=n.scales={},R=n.bands=i.bands||[];R.forEach(v=>{v.fill=xt(v.fill||null),v.dir=wt(v.dir,-1)});let M=s==2?x[1].facets[0].scale:x[0].scale,_={axes:ws,series:pt},E=(i.drawOrder||["axes","series"]).map(v=>_[v]);function k(v){let w=v.distr==3?I=>Gs(I>0?I:v.clamp(n,I,v.min,v.max,v.key)):v.distr==4?I=>Xf(I,v.asinh):v.distr==100?I=>v.fwd(I):I=>I;return I=>{let D=w(I),{_min:H,_max:K}=v,ae=K-H;return(D-H)/ae}}function N(v){let w=S[v];if(w==null){let I=(i.scales||Ml)[v]||Ml;if(I.from!=null){N(I.from);let D=wn({},S[I.from],I,{key:v});D.valToPct=k(D),S[v]=D}else{w=S[v]=wn({},v==M?b_:KE,I),w.key=v;let D=w.time,H=w.range,K=mr(H);if((v!=M||s==2&&!D)&&(K&&(H[0]==null||H[1]==null)&&(H={min:H[0]==null?by:{mode:1,hard:H[0],soft:H[0]},max:H[1]==null?by:{mode:1,hard:H[1],soft:H[1]}},K=!1),!K&&Su(H))){let ae=H;H=(de,be,Ne)=>be==null?Zo:yu(be,Ne,ae)}w.range=xt(H||(D?cA:v==M?w.distr==3?uA:w.distr==4?dA:I_:w.distr==3?L_:w.distr==4?N_:hA)),w.auto=xt(K?!1:w.auto),w.clamp=xt(w.clamp||ZE),w._min=w._max=null,w.valToPct=k(w)}}}N("x"),N("y"),s==1&&x.forEach(v=>{N(v.scale)}),A.forEach(v=>{N(v.scale)});for(let v in i.scales)N(v);let L=S[M],B=L.distr,V,P;L.ori==0?(Ei(c,ST),V=r,P=o):(Ei(c,MT),V=o,P=r);let F={};for(let v in S){let w=S[v];(w.min!=null||w.max!=null)&&(F[v]={min:w.min,max:w.max},w.min=w.max=null)}let X=i.tzDate||(v=>new Date(Ln(v/m))),G=i.fmtDate||dp,oe=m==1?SE(X):TE(X),$=Ly(X,Iy(m==1?bE:wE,G)),J=Dy(X,Ny(AE,G)),ne=[],ue=n.legend=wn({},PE,i.legend),ce=n.cursor=wn({},UE,{drag:{y:s==2}},i.cursor),Q=ue.show,pe=ce.show,me=ue.markers;ue.idxs=ne,me.width=xt(me.width),me.dash=xt(me.dash),me.stroke=xt(me.stroke),me.fill=xt(me.fill);let ye,ge,Ve,Je=[],Ue=[],rt,ct=!1,ot={};if(ue.live){let v=x[1]?x[1].values:null;ct=v!=null,rt=ct?v(n,1,0):{_:0};for(let w in rt)ot[w]=op}if(Q)if(ye=is("table",NT,c),Ve=is("tbody",null,ye),ue.mount(n,ye),ct){ge=is("thead",null,ye,Ve);let v=is("tr",null,ge);is("th",null,v);for(var jt in rt)is("th",ly,v).textContent=jt}else Ei(ye,FT),ue.live&&Ei(ye,DT);let Gt={show:!0},pn={show:!1};function Dt(v,w){if(w==0&&(ct||!ue.live||s==2))return Zo;let I=[],D=is("tr",UT,Ve,Ve.childNodes[w]);Ei(D,v.class),v.show||Ei(D,Gr);let H=is("th",null,D);if(me.show){let de=Bi(OT,H);if(w>0){let be=me.width(n,w);be&&(de.style.border=be+"px "+me.dash(n,w)+" "+me.stroke(n,w)),de.style.background=me.fill(n,w)}}let K=Bi(ly,H);v.label instanceof HTMLElement?K.appendChild(v.label):K.textContent=v.label,w>0&&(me.show||(K.style.color=v.width>0?me.stroke(n,w):me.fill(n,w)),bt("click",H,de=>{if(ce._lock)return;Qe(de);let be=x.indexOf(v);if((de.ctrlKey||de.metaKey)!=ue.isolate){let Ne=x.some((De,Oe)=>Oe>0&&Oe!=be&&De.show);x.forEach((De,Oe)=>{Oe>0&&hs(Oe,Ne?Oe==be?Gt:pn:Gt,!0,vn.setSeries)})}else hs(be,{show:!v.show},!0,vn.setSeries)},!1),et&&bt(dy,H,de=>{ce._lock||(Qe(de),hs(x.indexOf(v),to,!0,vn.setSeries))},!1));for(var ae in rt){let de=is("td",kT,D);de.textContent="--",I.push(de)}return[D,I]}let Dn=new Map;function bt(v,w,I,D=!0){let H=Dn.get(w)||{},K=ce.bind[v](n,w,I,D);K&&(Hr(v,w,H[v]=K),Dn.set(w,H))}function Tn(v,w,I){let D=Dn.get(w)||{};for(let H in D)(v==null||H==v)&&(jf(H,w,D[H]),delete D[H]);v==null&&Dn.delete(w)}let rn=0,mn=0,O=0,Ce=0,Ke=0,lt=0,we=Ke,Ot=lt,Ge=O,qe=Ce,C=0,b=0,q=0,he=0;n.bbox={};let re=!1,ve=!1,xe=!1,ee=!1,ie=!1,fe=!1;function U(v,w,I){(I||v!=n.width||w!=n.height)&&se(v,w),ut(!1),xe=!0,ve=!0,qn()}function se(v,w){n.width=rn=O=v,n.height=mn=Ce=w,Ke=lt=0,Me(),He();let I=n.bbox;C=I.left=zr(Ke*At,.5),b=I.top=zr(lt*At,.5),q=I.width=zr(O*At,.5),he=I.height=zr(Ce*At,.5)}let te=3;function Te(){let v=!1,w=0;for(;!v;){w++;let I=Zr(w),D=cs(w);v=w==te||I&&D,v||(se(n.width,n.height),ve=!0)}}function _e({width:v,height:w}){U(v,w)}n.setSize=_e;function Me(){let v=!1,w=!1,I=!1,D=!1;A.forEach((H,K)=>{if(H.show&&H._show){let{side:ae,_size:de}=H,be=ae%2,Ne=H.label!=null?H.labelSize:0,De=de+Ne;De>0&&(be?(O-=De,ae==3?(Ke+=De,D=!0):I=!0):(Ce-=De,ae==0?(lt+=De,v=!0):w=!0))}}),as[0]=v,as[1]=I,as[2]=w,as[3]=D,O-=Vi[1]+Vi[3],Ke+=Vi[3],Ce-=Vi[2]+Vi[0],lt+=Vi[0]}function He(){let v=Ke+O,w=lt+Ce,I=Ke,D=lt;function H(K,ae){switch(K){case 1:return v+=ae,v-ae;case 2:return w+=ae,w-ae;case 3:return I-=ae,I+ae;case 0:return D-=ae,D+ae}}A.forEach((K,ae)=>{if(K.show&&K._show){let de=K.side;K._pos=H(de,K._size),K.label!=null&&(K._lpos=H(de,K.labelSize))}})}if(ce.dataIdx==null){let v=ce.hover,w=v.skip=new Set(v.skip??[]);w.add(void 0);let I=v.prox=xt(v.prox),D=v.bias??=0;ce.dataIdx=(H,K,ae,de)=>{if(K==0)return ae;let be=ae,Ne=I(H,K,ae,de)??zt,De=Ne>=0&&Ne<zt,Oe=L.ori==0?O:Ce,at=ce.left,Tt=e[0],St=e[K];if(w.has(St[ae])){be=null;let yt=null,je=null,We;if(D==0||D==-1)for(We=ae;yt==null&&We-- >0;)w.has(St[We])||(yt=We);if(D==0||D==1)for(We=ae;je==null&&We++<St.length;)w.has(St[We])||(je=We);if(yt!=null||je!=null)if(De){let $t=yt==null?-1/0:V(Tt[yt],L,Oe,0),ln=je==null?1/0:V(Tt[je],L,Oe,0),kn=at-$t,Ft=ln-at;kn<=Ft?kn<=Ne&&(be=yt):Ft<=Ne&&(be=je)}else be=je==null?yt:yt==null?je:ae-yt<=je-ae?yt:je}else De&&Nn(at-V(Tt[ae],L,Oe,0))>Ne&&(be=null);return be}}let Qe=v=>{ce.event=v};ce.idxs=ne,ce._lock=!1;let le=ce.points;le.show=xt(le.show),le.size=xt(le.size),le.stroke=xt(le.stroke),le.width=xt(le.width),le.fill=xt(le.fill);let ke=n.focus=wn({},i.focus||{alpha:.3},ce.focus),et=ke.prox>=0,Re=et&&le.one,ht=[],Wt=[],jn=[];function ta(v,w){let I=le.show(n,w);if(I instanceof HTMLElement)return Ei(I,LT),Ei(I,v.class),xs(I,-10,-10,O,Ce),g.insertBefore(I,ht[w]),I}function qr(v,w){if(s==1||w>0){let I=s==1&&S[v.scale].time,D=v.value;v.value=I?Ay(D)?Dy(X,Ny(D,G)):D||J:D||qE,v.label=v.label||(I?kE:OE)}if(Re||w>0){v.width=v.width==null?1:v.width,v.paths=v.paths||oA||KT,v.fillTo=xt(v.fillTo||JE),v.pxAlign=+wt(v.pxAlign,y),v.pxRound=Hy(v.pxAlign),v.stroke=xt(v.stroke||null),v.fill=xt(v.fill||null),v._stroke=v._fill=v._paths=v._focus=null;let I=$E(li(1,v.width),1),D=v.points=wn({},{size:I,width:li(1,I*.2),stroke:v.stroke,space:I*2,paths:aA,_stroke:null,_fill:null},v.points);D.show=xt(D.show),D.filter=xt(D.filter),D.fill=xt(D.fill),D.stroke=xt(D.stroke),D.paths=xt(D.paths),D.pxAlign=v.pxAlign}if(Q){let I=Dt(v,w);Je.splice(w,0,I[0]),Ue.splice(w,0,I[1]),ue.values.push(null)}if(pe){ne.splice(w,0,null);let I=null;Re?w==0&&(I=ta(v,w)):w>0&&(I=ta(v,w)),ht.splice(w,0,I),Wt.splice(w,0,0),jn.splice(w,0,0)}On("addSeries",w)}function Vu(v,w){w=w??x.length,v=s==1?sp(v,w,Uy,Vy):sp(v,w,{},zy),x.splice(w,0,v),qr(x[w],w)}n.addSeries=Vu;function Al(v){if(x.splice(v,1),Q){ue.values.splice(v,1),Ue.splice(v,1);let w=Je.splice(v,1)[0];Tn(null,w.firstChild),w.remove()}pe&&(ne.splice(v,1),ht.splice(v,1)[0].remove(),Wt.splice(v,1),jn.splice(v,1)),On("delSeries",v)}n.delSeries=Al;let as=[!1,!1,!1,!1];function bs(v,w){if(v._show=v.show,v.show){let I=v.side%2,D=S[v.scale];D==null&&(v.scale=I?x[1].scale:M,D=S[v.scale]);let H=D.time;v.size=xt(v.size),v.space=xt(v.space),v.rotate=xt(v.rotate),mr(v.incrs)&&v.incrs.forEach(ae=>{!gr.has(ae)&&gr.set(ae,n_(ae))}),v.incrs=xt(v.incrs||(D.distr==2?_E:H?m==1?xE:ME:Vr)),v.splits=xt(v.splits||(H&&D.distr==1?oe:D.distr==3?ep:D.distr==4?VE:zE)),v.stroke=xt(v.stroke),v.grid.stroke=xt(v.grid.stroke),v.ticks.stroke=xt(v.ticks.stroke),v.border.stroke=xt(v.border.stroke);let K=v.values;v.values=mr(K)&&!mr(K[0])?xt(K):H?mr(K)?Ly(X,Iy(K,G)):Ay(K)?EE(X,K):K||$:K||BE,v.filter=xt(v.filter||(D.distr>=3&&D.log==10?WE:D.distr==3&&D.log==2?XE:e_)),v.font=$y(v.font),v.labelFont=$y(v.labelFont),v._size=v.size(n,null,w,0),v._space=v._rotate=v._incrs=v._found=v._splits=v._values=null,v._size>0&&(as[w]=!0,v._el=Bi(RT,u))}}function Ss(v,w,I,D){let[H,K,ae,de]=I,be=w%2,Ne=0;return be==0&&(de||K)&&(Ne=w==0&&!H||w==2&&!ae?Ln(Fy.size/3):0),be==1&&(H||ae)&&(Ne=w==1&&!K||w==3&&!de?Ln(ky.size/2):0),Ne}let na=n.padding=(i.padding||[Ss,Ss,Ss,Ss]).map(v=>xt(wt(v,Ss))),Vi=n._padding=na.map((v,w)=>v(n,w,as,0)),on,un=null,dn=null,ls=s==1?x[0].idxs:null,fi=null,Ws=!1;function ia(v,w){if(e=v??[],n.data=n._data=e,s==2){on=0;for(let I=1;I<x.length;I++)on+=e[I][0].length}else{e.length==0&&(n.data=n._data=e=[[]]),fi=e[0],on=fi.length;let I=e;if(B==2){I=e.slice();let D=I[0]=Array(on);for(let H=0;H<on;H++)D[H]=H}n._data=e=I}if(ut(!0),On("setData"),B==2&&(xe=!0),w!==!1){let I=L;I.auto(n,Ws)?sa():$s(M,I.min,I.max),ee=ee||ce.left>=0,fe=!0,qn()}}n.setData=ia;function sa(){Ws=!0;let v,w;s==1&&(on>0?(un=ls[0]=0,dn=ls[1]=on-1,v=e[0][un],w=e[0][dn],B==2?(v=un,w=dn):v==w&&(B==3?[v,w]=xu(v,v,L.log,!1):B==4?[v,w]=lp(v,v,L.log,!1):L.time?w=v+Ln(86400/m):[v,w]=yu(v,w,cp,!0))):(un=ls[0]=v=null,dn=ls[1]=w=null)),$s(M,v,w)}let $r,Xs,Yr,T,z,j,Y,Z,Ee,Pe;function Ae(v,w,I,D,H,K){v??=hy,I??=up,D??="butt",H??=hy,K??="round",v!=$r&&(d.strokeStyle=$r=v),H!=Xs&&(d.fillStyle=Xs=H),w!=Yr&&(d.lineWidth=Yr=w),K!=z&&(d.lineJoin=z=K),D!=j&&(d.lineCap=j=D),I!=T&&d.setLineDash(T=I)}function Ie(v,w,I,D){w!=Xs&&(d.fillStyle=Xs=w),v!=Y&&(d.font=Y=v),I!=Z&&(d.textAlign=Z=I),D!=Ee&&(d.textBaseline=Ee=D)}function ze(v,w,I,D,H=0){if(D.length>0&&v.auto(n,Ws)&&(w==null||w.min==null)){let K=wt(un,0),ae=wt(dn,D.length-1),de=I.min==null?WT(D,K,ae,H,v.distr==3):[I.min,I.max];v.min=rs(v.min,I.min=de[0]),v.max=li(v.max,I.max=de[1])}}let nt={min:null,max:null};function ft(){for(let D in S){let H=S[D];F[D]==null&&(H.min==null||F[M]!=null&&H.auto(n,Ws))&&(F[D]=nt)}for(let D in S){let H=S[D];F[D]==null&&H.from!=null&&F[H.from]!=null&&(F[D]=nt)}F[M]!=null&&ut(!0);let v={};for(let D in F){let H=F[D];if(H!=null){let K=v[D]=Ko(S[D],QT);if(H.min!=null)wn(K,H);else if(D!=M||s==2)if(on==0&&K.from==null){let ae=K.range(n,null,null,D);K.min=ae[0],K.max=ae[1]}else K.min=zt,K.max=-zt}}if(on>0){x.forEach((D,H)=>{if(s==1){let K=D.scale,ae=F[K];if(ae==null)return;let de=v[K];if(H==0){let be=de.range(n,de.min,de.max,K);de.min=be[0],de.max=be[1],un=ss(de.min,e[0]),dn=ss(de.max,e[0]),dn-un>1&&(e[0][un]<de.min&&un++,e[0][dn]>de.max&&dn--),D.min=fi[un],D.max=fi[dn]}else D.show&&D.auto&&ze(de,ae,D,e[H],D.sorted);D.idxs[0]=un,D.idxs[1]=dn}else if(H>0&&D.show&&D.auto){let[K,ae]=D.facets,de=K.scale,be=ae.scale,[Ne,De]=e[H],Oe=v[de],at=v[be];Oe!=null&&ze(Oe,F[de],K,Ne,K.sorted),at!=null&&ze(at,F[be],ae,De,ae.sorted),D.min=ae.min,D.max=ae.max}});for(let D in v){let H=v[D],K=F[D];if(H.from==null&&(K==null||K.min==null)){let ae=H.range(n,H.min==zt?null:H.min,H.max==-zt?null:H.max,D);H.min=ae[0],H.max=ae[1]}}}for(let D in v){let H=v[D];if(H.from!=null){let K=v[H.from];if(K.min==null)H.min=H.max=null;else{let ae=H.range(n,K.min,K.max,D);H.min=ae[0],H.max=ae[1]}}}let w={},I=!1;for(let D in v){let H=v[D],K=S[D];if(K.min!=H.min||K.max!=H.max){K.min=H.min,K.max=H.max;let ae=K.distr;K._min=ae==3?Gs(K.min):ae==4?Xf(K.min,K.asinh):ae==100?K.fwd(K.min):K.min,K._max=ae==3?Gs(K.max):ae==4?Xf(K.max,K.asinh):ae==100?K.fwd(K.max):K.max,w[D]=I=!0}}if(I){x.forEach((D,H)=>{s==2?H>0&&w.y&&(D._paths=null):w[D.scale]&&(D._paths=null)});for(let D in w)xe=!0,On("setScale",D);pe&&ce.left>=0&&(ee=fe=!0)}for(let D in F)F[D]=null}function Be(v){let w=Qf(un-1,0,on-1),I=Qf(dn+1,0,on-1);for(;v[w]==null&&w>0;)w--;for(;v[I]==null&&I<on-1;)I++;return[w,I]}function pt(){if(on>0){let v=x.some(w=>w._focus)&&Pe!=ke.alpha;v&&(d.globalAlpha=Pe=ke.alpha),x.forEach((w,I)=>{if(I>0&&w.show&&(sn(I,!1),sn(I,!0),w._paths==null)){let D=Pe;Pe!=w.alpha&&(d.globalAlpha=Pe=w.alpha);let H=s==2?[0,e[I][0].length-1]:Be(e[I]);w._paths=w.paths(n,I,H[0],H[1]),Pe!=D&&(d.globalAlpha=Pe=D)}}),x.forEach((w,I)=>{if(I>0&&w.show){let D=Pe;Pe!=w.alpha&&(d.globalAlpha=Pe=w.alpha),w._paths!=null&&It(I,!1);{let H=w._paths!=null?w._paths.gaps:null,K=w.points.show(n,I,un,dn,H),ae=w.points.filter(n,I,K,H);(K||ae)&&(w.points._paths=w.points.paths(n,I,un,dn,ae),It(I,!0))}Pe!=D&&(d.globalAlpha=Pe=D),On("drawSeries",I)}}),v&&(d.globalAlpha=Pe=1)}}function sn(v,w){let I=w?x[v].points:x[v];I._stroke=I.stroke(n,v),I._fill=I.fill(n,v)}function It(v,w){let I=w?x[v].points:x[v],{stroke:D,fill:H,clip:K,flags:ae,_stroke:de=I._stroke,_fill:be=I._fill,_width:Ne=I.width}=I._paths;Ne=Vt(Ne*At,3);let De=null,Oe=Ne%2/2;w&&be==null&&(be=Ne>0?"#fff":de);let at=I.pxAlign==1&&Oe>0;if(at&&d.translate(Oe,Oe),!w){let Tt=C-Ne/2,St=b-Ne/2,yt=q+Ne,je=he+Ne;De=new Path2D,De.rect(Tt,St,yt,je)}w?Fe(de,Ne,I.dash,I.cap,be,D,H,ae,K):Lt(v,de,Ne,I.dash,I.cap,be,D,H,ae,De,K),at&&d.translate(-Oe,-Oe)}function Lt(v,w,I,D,H,K,ae,de,be,Ne,De){let Oe=!1;be!=0&&R.forEach((at,Tt)=>{if(at.series[0]==v){let St=x[at.series[1]],yt=e[at.series[1]],je=(St._paths||Ml).band;mr(je)&&(je=at.dir==1?je[0]:je[1]);let We,$t=null;St.show&&je&&qT(yt,un,dn)?($t=at.fill(n,Tt)||K,We=St._paths.clip):je=null,Fe(w,I,D,H,$t,ae,de,be,Ne,De,We,je),Oe=!0}}),Oe||Fe(w,I,D,H,K,ae,de,be,Ne,De)}let En=Jo|np;function Fe(v,w,I,D,H,K,ae,de,be,Ne,De,Oe){Ae(v,w,I,D,H),(be||Ne||Oe)&&(d.save(),be&&d.clip(be),Ne&&d.clip(Ne)),Oe?(de&En)==En?(d.clip(Oe),De&&d.clip(De),_t(H,ae),gn(v,K,w)):de&np?(_t(H,ae),d.clip(Oe),gn(v,K,w)):de&Jo&&(d.save(),d.clip(Oe),De&&d.clip(De),_t(H,ae),d.restore(),gn(v,K,w)):(_t(H,ae),gn(v,K,w)),(be||Ne||Oe)&&d.restore()}function gn(v,w,I){I>0&&(w instanceof Map?w.forEach((D,H)=>{d.strokeStyle=$r=H,d.stroke(D)}):w!=null&&v&&d.stroke(w))}function _t(v,w){w instanceof Map?w.forEach((I,D)=>{d.fillStyle=Xs=D,d.fill(I)}):w!=null&&v&&d.fill(w)}function Ms(v,w,I,D){let H=A[v],K;if(D<=0)K=[0,0];else{let ae=H._space=H.space(n,v,w,I,D),de=H._incrs=H.incrs(n,v,w,I,D,ae);K=fA(w,I,de,D,ae)}return H._found=K}function yn(v,w,I,D,H,K,ae,de,be,Ne){let De=ae%2/2;y==1&&d.translate(De,De),Ae(de,ae,be,Ne,de),d.beginPath();let Oe,at,Tt,St,yt=H+(D==0||D==3?-K:K);I==0?(at=H,St=yt):(Oe=H,Tt=yt);for(let je=0;je<v.length;je++)w[je]!=null&&(I==0?Oe=Tt=v[je]:at=St=v[je],d.moveTo(Oe,at),d.lineTo(Tt,St));d.stroke(),y==1&&d.translate(-De,-De)}function Zr(v){let w=!0;return A.forEach((I,D)=>{if(!I.show)return;let H=S[I.scale];if(H.min==null){I._show&&(w=!1,I._show=!1,ut(!1));return}else I._show||(w=!1,I._show=!0,ut(!1));let K=I.side,ae=K%2,{min:de,max:be}=H,[Ne,De]=Ms(D,de,be,ae==0?O:Ce);if(De==0)return;let Oe=H.distr==2,at=I._splits=I.splits(n,D,de,be,Ne,De,Oe),Tt=H.distr==2?at.map(We=>fi[We]):at,St=H.distr==2?fi[at[1]]-fi[at[0]]:Ne,yt=I._values=I.values(n,I.filter(n,Tt,D,De,St),D,De,St);I._rotate=K==2?I.rotate(n,yt,D,De):0;let je=I._size;I._size=zi(I.size(n,yt,D,v)),je!=null&&I._size!=je&&(w=!1)}),w}function cs(v){let w=!0;return na.forEach((I,D)=>{let H=I(n,D,as,v);H!=Vi[D]&&(w=!1),Vi[D]=H}),w}function ws(){for(let v=0;v<A.length;v++){let w=A[v];if(!w.show||!w._show)continue;let I=w.side,D=I%2,H,K,ae=w.stroke(n,v),de=I==0||I==3?-1:1,[be,Ne]=w._found;if(w.label!=null){let ti=w.labelGap*de,gi=Ln((w._lpos+ti)*At);Ie(w.labelFont[0],ae,"center",I==2?"top":cy),d.save(),D==1?(H=K=0,d.translate(gi,Ln(b+he/2)),d.rotate((I==3?-mu:mu)/2)):(H=Ln(C+q/2),K=gi);let vr=jy(w.label)?w.label(n,v,be,Ne):w.label;d.fillText(vr,H,K),d.restore()}if(Ne==0)continue;let De=S[w.scale],Oe=D==0?q:he,at=D==0?C:b,Tt=w._splits,St=De.distr==2?Tt.map(ti=>fi[ti]):Tt,yt=De.distr==2?fi[Tt[1]]-fi[Tt[0]]:be,je=w.ticks,We=w.border,$t=je.show?je.size:0,ln=Ln($t*At),kn=Ln((w.alignTo==2?w._size-$t-w.gap:w.gap)*At),Ft=w._rotate*-mu/180,cn=p(w._pos*At),pi=(ln+kn)*de,ei=cn+pi;K=D==0?ei:0,H=D==1?ei:0;let Ci=w.font[0],Gi=w.align==1?Xo:w.align==2?Gf:Ft>0?Xo:Ft<0?Gf:D==0?"center":I==3?Gf:Xo,ds=Ft||D==1?"middle":I==2?"top":cy;Ie(Ci,ae,Gi,ds);let mi=w.font[1]*w.lineGap,Pi=Tt.map(ti=>p(a(ti,De,Oe,at))),Hi=w._values;for(let ti=0;ti<Hi.length;ti++){let gi=Hi[ti];if(gi!=null){D==0?H=Pi[ti]:K=Pi[ti],gi=""+gi;let vr=gi.indexOf(`
`)==-1?[gi]:gi.split(/\n/gm);for(let ni=0;ni<vr.length;ni++){let Xp=vr[ni];Ft?(d.save(),d.translate(H,K+ni*mi),d.rotate(Ft),d.fillText(Xp,0,0),d.restore()):d.fillText(Xp,H,K+ni*mi)}}}je.show&&yn(Pi,je.filter(n,St,v,Ne,yt),D,I,cn,ln,Vt(je.width*At,3),je.stroke(n,v),je.dash,je.cap);let fs=w.grid;fs.show&&yn(Pi,fs.filter(n,St,v,Ne,yt),D,D==0?2:1,D==0?b:C,D==0?he:q,Vt(fs.width*At,3),fs.stroke(n,v),fs.dash,fs.cap),We.show&&yn([cn],[1],D==0?1:0,D==0?1:2,D==1?b:C,D==1?he:q,Vt(We.width*At,3),We.stroke(n,v),We.dash,We.cap)}On("drawAxes")}function ut(v){x.forEach((w,I)=>{I>0&&(w._paths=null,v&&(s==1?(w.min=null,w.max=null):w.facets.forEach(D=>{D.min=null,D.max=null})))})}let an=!1,Qn=!1,Nt=[];function _n(){Qn=!1;for(let v=0;v<Nt.length;v++)On(...Nt[v]);Nt.length=0}function qn(){an||(oE(Ap),an=!0)}function Rl(v,w=!1){an=!0,Qn=w,v(n),Ap(),w&&Nt.length>0&&queueMicrotask(_n)}n.batch=Rl;function Ap(){if(re&&(ft(),re=!1),xe&&(Te(),xe=!1),ve){if(Kt(f,Xo,Ke),Kt(f,"top",lt),Kt(f,vl,O),Kt(f,xl,Ce),Kt(g,Xo,Ke),Kt(g,"top",lt),Kt(g,vl,O),Kt(g,xl,Ce),Kt(u,vl,rn),Kt(u,xl,mn),h.width=Ln(rn*At),h.height=Ln(mn*At),A.forEach(({_el:v,_show:w,_size:I,_pos:D,side:H})=>{if(v!=null)if(w){let K=H===3||H===0?I:0,ae=H%2==1;Kt(v,ae?"left":"top",D-K),Kt(v,ae?"width":"height",I),Kt(v,ae?"top":"left",ae?lt:Ke),Kt(v,ae?"height":"width",ae?Ce:O),Jf(v,Gr)}else Ei(v,Gr)}),$r=Xs=Yr=z=j=Y=Z=Ee=T=null,Pe=1,aa(!0),Ke!=we||lt!=Ot||O!=Ge||Ce!=qe){ut(!1);let v=O/Ge,w=Ce/qe;if(pe&&!ee&&ce.left>=0){ce.left*=v,ce.top*=w,Kr&&xs(Kr,Ln(ce.left),0,O,Ce),Jr&&xs(Jr,0,Ln(ce.top),O,Ce);for(let I=0;I<ht.length;I++){let D=ht[I];D!=null&&(Wt[I]*=v,jn[I]*=w,xs(D,zi(Wt[I]),zi(jn[I]),O,Ce))}}if(qt.show&&!ie&&qt.left>=0&&qt.width>0){qt.left*=v,qt.width*=v,qt.top*=w,qt.height*=w;for(let I in $u)Kt(eo,I,qt[I])}we=Ke,Ot=lt,Ge=O,qe=Ce}On("setSize"),ve=!1}rn>0&&mn>0&&(d.clearRect(0,0,h.width,h.height),On("drawClear"),E.forEach(v=>v()),On("draw")),qt.show&&ie&&(Cl(qt),ie=!1),pe&&ee&&(_r(null,!0,!1),ee=!1),ue.show&&ue.live&&fe&&(Xu(),fe=!1),l||(l=!0,n.status=1,On("ready")),Ws=!1,an=!1}n.redraw=(v,w)=>{xe=w||!1,v!==!1?$s(M,L.min,L.max):qn()};function Gu(v,w){let I=S[v];if(I.from==null){if(on==0){let D=I.range(n,w.min,w.max,v);w.min=D[0],w.max=D[1]}if(w.min>w.max){let D=w.min;w.min=w.max,w.max=D}if(on>1&&w.min!=null&&w.max!=null&&w.max-w.min<1e-16)return;v==M&&I.distr==2&&on>0&&(w.min=ss(w.min,e[0]),w.max=ss(w.max,e[0]),w.min==w.max&&w.max++),F[v]=w,re=!0,qn()}}n.setScale=Gu;let Hu,Wu,Kr,Jr,Rp,Cp,jr,Qr,Pp,Ip,Xt,Qt,qs=!1,Hn=ce.drag,Fn=Hn.x,Un=Hn.y;pe&&(ce.x&&(Hu=Bi(PT,g)),ce.y&&(Wu=Bi(IT,g)),L.ori==0?(Kr=Hu,Jr=Wu):(Kr=Wu,Jr=Hu),Xt=ce.left,Qt=ce.top);let qt=n.select=wn({show:!0,over:!0,left:0,width:0,top:0,height:0},i.select),eo=qt.show?Bi(CT,qt.over?g:f):null;function Cl(v,w){if(qt.show){for(let I in v)qt[I]=v[I],I in $u&&Kt(eo,I,v[I]);w!==!1&&On("setSelect")}}n.setSelect=Cl;function H_(v){if(x[v].show)Q&&Jf(Je[v],Gr);else if(Q&&Ei(Je[v],Gr),pe){let I=Re?ht[0]:ht[v];I!=null&&xs(I,-10,-10,O,Ce)}}function $s(v,w,I){Gu(v,{min:w,max:I})}function hs(v,w,I,D){w.focus!=null&&Y_(v),w.show!=null&&x.forEach((H,K)=>{K>0&&(v==K||v==null)&&(H.show=w.show,H_(K),s==2?($s(H.facets[0].scale,null,null),$s(H.facets[1].scale,null,null)):$s(H.scale,null,null),qn())}),I!==!1&&On("setSeries",v,w),D&&la("setSeries",n,v,w)}n.setSeries=hs;function W_(v,w){wn(R[v],w)}function X_(v,w){v.fill=xt(v.fill||null),v.dir=wt(v.dir,-1),w=w??R.length,R.splice(w,0,v)}function q_(v){v==null?R.length=0:R.splice(v,1)}n.addBand=X_,n.setBand=W_,n.delBand=q_;function $_(v,w){x[v].alpha=w,pe&&ht[v]!=null&&(ht[v].style.opacity=w),Q&&Je[v]&&(Je[v].style.opacity=w)}let Ts,Ys,yr,to={focus:!0};function Y_(v){if(v!=yr){let w=v==null,I=ke.alpha!=1;x.forEach((D,H)=>{if(s==1||H>0){let K=w||H==0||H==v;D._focus=w?null:K,I&&$_(H,K?1:ke.alpha)}}),yr=v,I&&qn()}}Q&&et&&bt(fy,ye,v=>{ce._lock||(Qe(v),yr!=null&&hs(null,to,!0,vn.setSeries))});function us(v,w,I){let D=S[w];I&&(v=v/At-(D.ori==1?lt:Ke));let H=O;D.ori==1&&(H=Ce,v=H-v),D.dir==-1&&(v=H-v);let K=D._min,ae=D._max,de=v/H,be=K+(ae-K)*de,Ne=D.distr;return Ne==3?Yo(10,be):Ne==4?YT(be,D.asinh):Ne==100?D.bwd(be):be}function Z_(v,w){let I=us(v,M,w);return ss(I,e[0],un,dn)}n.valToIdx=v=>ss(v,e[0]),n.posToIdx=Z_,n.posToVal=us,n.valToPos=(v,w,I)=>S[w].ori==0?r(v,S[w],I?q:O,I?C:0):o(v,S[w],I?he:Ce,I?b:0),n.setCursor=(v,w,I)=>{Xt=v.left,Qt=v.top,_r(null,w,I)};function Lp(v,w){Kt(eo,Xo,qt.left=v),Kt(eo,vl,qt.width=w)}function Np(v,w){Kt(eo,"top",qt.top=v),Kt(eo,xl,qt.height=w)}let ra=L.ori==0?Lp:Np,oa=L.ori==1?Lp:Np;function K_(){if(Q&&ue.live)for(let v=s==2?1:0;v<x.length;v++){if(v==0&&ct)continue;let w=ue.values[v],I=0;for(let D in w)Ue[v][I++].firstChild.nodeValue=w[D]}}function Xu(v,w){if(v!=null&&(v.idxs?v.idxs.forEach((I,D)=>{ne[D]=I}):jT(v.idx)||ne.fill(v.idx),ue.idx=ne[0]),Q&&ue.live){for(let I=0;I<x.length;I++)(I>0||s==1&&!ct)&&J_(I,ne[I]);K_()}fe=!1,w!==!1&&On("setLegend")}n.setLegend=Xu;function J_(v,w){let I=x[v],D=v==0&&B==2?fi:e[v],H;ct?H=I.values(n,v,w)??ot:(H=I.value(n,w==null?null:D[w],v,w),H=H==null?ot:{_:H}),ue.values[v]=H}function _r(v,w,I){Pp=Xt,Ip=Qt,[Xt,Qt]=ce.move(n,Xt,Qt),ce.left=Xt,ce.top=Qt,pe&&(Kr&&xs(Kr,Ln(Xt),0,O,Ce),Jr&&xs(Jr,0,Ln(Qt),O,Ce));let D,H=un>dn;Ts=zt,Ys=null;let K=L.ori==0?O:Ce,ae=L.ori==1?O:Ce;if(Xt<0||on==0||H){D=ce.idx=null;for(let de=0;de<x.length;de++){let be=ht[de];be!=null&&xs(be,-10,-10,O,Ce)}et&&hs(null,to,!0,v==null&&vn.setSeries),ue.live&&(ne.fill(D),fe=!0)}else{let de,be,Ne;s==1&&(de=L.ori==0?Xt:Qt,be=us(de,M),D=ce.idx=ss(be,e[0],un,dn),Ne=V(e[0][D],L,K,0));let De=-10,Oe=-10,at=0,Tt=0,St=!0,yt="",je="";for(let We=s==2?1:0;We<x.length;We++){let $t=x[We],ln=ne[We],kn=ln==null?null:s==1?e[We][ln]:e[We][1][ln],Ft=ce.dataIdx(n,We,D,be),cn=Ft==null?null:s==1?e[We][Ft]:e[We][1][Ft];if(fe=fe||cn!=kn||Ft!=ln,ne[We]=Ft,We>0&&$t.show){let pi=Ft==null?-10:Ft==D?Ne:V(s==1?e[0][Ft]:e[We][0][Ft],L,K,0),ei=cn==null?-10:P(cn,s==1?S[$t.scale]:S[$t.facets[1].scale],ae,0);if(et&&cn!=null){let Ci=L.ori==1?Xt:Qt,Gi=Nn(ke.dist(n,We,Ft,ei,Ci));if(Gi<Ts){let ds=ke.bias;if(ds!=0){let mi=us(Ci,$t.scale),Pi=cn>=0?1:-1,Hi=mi>=0?1:-1;Hi==Pi&&(Hi==1?ds==1?cn>=mi:cn<=mi:ds==1?cn<=mi:cn>=mi)&&(Ts=Gi,Ys=We)}else Ts=Gi,Ys=We}}if(fe||Re){let Ci,Gi;L.ori==0?(Ci=pi,Gi=ei):(Ci=ei,Gi=pi);let ds,mi,Pi,Hi,fs,ti,gi=!0,vr=le.bbox;if(vr!=null){gi=!1;let ni=vr(n,We);Pi=ni.left,Hi=ni.top,ds=ni.width,mi=ni.height}else Pi=Ci,Hi=Gi,ds=mi=le.size(n,We);if(ti=le.fill(n,We),fs=le.stroke(n,We),Re)We==Ys&&Ts<=ke.prox&&(De=Pi,Oe=Hi,at=ds,Tt=mi,St=gi,yt=ti,je=fs);else{let ni=ht[We];ni!=null&&(Wt[We]=Pi,jn[We]=Hi,xy(ni,ds,mi,gi),_y(ni,ti,fs),xs(ni,zi(Pi),zi(Hi),O,Ce))}}}}if(Re){let We=ke.prox,$t=yr==null?Ts<=We:Ts>We||Ys!=yr;if(fe||$t){let ln=ht[0];ln!=null&&(Wt[0]=De,jn[0]=Oe,xy(ln,at,Tt,St),_y(ln,yt,je),xs(ln,zi(De),zi(Oe),O,Ce))}}}if(qt.show&&qs)if(v!=null){let[de,be]=vn.scales,[Ne,De]=vn.match,[Oe,at]=v.cursor.sync.scales,Tt=v.cursor.drag;if(Fn=Tt._x,Un=Tt._y,Fn||Un){let{left:St,top:yt,width:je,height:We}=v.select,$t=v.scales[Oe].ori,ln=v.posToVal,kn,Ft,cn,pi,ei,Ci=de!=null&&Ne(de,Oe),Gi=be!=null&&De(be,at);Ci&&Fn?($t==0?(kn=St,Ft=je):(kn=yt,Ft=We),cn=S[de],pi=V(ln(kn,Oe),cn,K,0),ei=V(ln(kn+Ft,Oe),cn,K,0),ra(rs(pi,ei),Nn(ei-pi))):ra(0,K),Gi&&Un?($t==1?(kn=St,Ft=je):(kn=yt,Ft=We),cn=S[be],pi=P(ln(kn,at),cn,ae,0),ei=P(ln(kn+Ft,at),cn,ae,0),oa(rs(pi,ei),Nn(ei-pi))):oa(0,ae)}else Yu()}else{let de=Nn(Pp-Rp),be=Nn(Ip-Cp);if(L.ori==1){let at=de;de=be,be=at}Fn=Hn.x&&de>=Hn.dist,Un=Hn.y&&be>=Hn.dist;let Ne=Hn.uni;Ne!=null?Fn&&Un&&(Fn=de>=Ne,Un=be>=Ne,!Fn&&!Un&&(be>de?Un=!0:Fn=!0)):Hn.x&&Hn.y&&(Fn||Un)&&(Fn=Un=!0);let De,Oe;Fn&&(L.ori==0?(De=jr,Oe=Xt):(De=Qr,Oe=Qt),ra(rs(De,Oe),Nn(Oe-De)),Un||oa(0,ae)),Un&&(L.ori==1?(De=jr,Oe=Xt):(De=Qr,Oe=Qt),oa(rs(De,Oe),Nn(Oe-De)),Fn||ra(0,K)),!Fn&&!Un&&(ra(0,0),oa(0,0))}if(Hn._x=Fn,Hn._y=Un,v==null){if(I){if(Wp!=null){let[de,be]=vn.scales;vn.values[0]=de!=null?us(L.ori==0?Xt:Qt,de):null,vn.values[1]=be!=null?us(L.ori==1?Xt:Qt,be):null}la(Hf,n,Xt,Qt,O,Ce,D)}if(et){let de=I&&vn.setSeries,be=ke.prox;yr==null?Ts<=be&&hs(Ys,to,!0,de):Ts>be?hs(null,to,!0,de):Ys!=yr&&hs(Ys,to,!0,de)}}fe&&(ue.idx=D,Xu()),w!==!1&&On("setCursor")}let Zs=null;Object.defineProperty(n,"rect",{get(){return Zs==null&&aa(!1),Zs}});function aa(v=!1){v?Zs=null:(Zs=g.getBoundingClientRect(),On("syncRect",Zs))}function Dp(v,w,I,D,H,K,ae){ce._lock||qs&&v!=null&&v.movementX==0&&v.movementY==0||(qu(v,w,I,D,H,K,ae,!1,v!=null),v!=null?_r(null,!0,!0):_r(w,!0,!1))}function qu(v,w,I,D,H,K,ae,de,be){if(Zs==null&&aa(!1),Qe(v),v!=null)I=v.clientX-Zs.left,D=v.clientY-Zs.top;else{if(I<0||D<0){Xt=-10,Qt=-10;return}let[Ne,De]=vn.scales,Oe=w.cursor.sync,[at,Tt]=Oe.values,[St,yt]=Oe.scales,[je,We]=vn.match,$t=w.axes[0].side%2==1,ln=L.ori==0?O:Ce,kn=L.ori==1?O:Ce,Ft=$t?K:H,cn=$t?H:K,pi=$t?D:I,ei=$t?I:D;if(St!=null?I=je(Ne,St)?a(at,S[Ne],ln,0):-10:I=ln*(pi/Ft),yt!=null?D=We(De,yt)?a(Tt,S[De],kn,0):-10:D=kn*(ei/cn),L.ori==1){let Ci=I;I=D,D=Ci}}be&&(w==null||w.cursor.event.type==Hf)&&((I<=1||I>=O-1)&&(I=zr(I,O)),(D<=1||D>=Ce-1)&&(D=zr(D,Ce))),de?(Rp=I,Cp=D,[jr,Qr]=ce.move(n,I,D)):(Xt=I,Qt=D)}let $u={width:0,height:0,left:0,top:0};function Yu(){Cl($u,!1)}let Fp,Up,Op,kp;function Bp(v,w,I,D,H,K,ae){qs=!0,Fn=Un=Hn._x=Hn._y=!1,qu(v,w,I,D,H,K,ae,!0,!1),v!=null&&(bt(Wf,Zf,zp,!1),la(uy,n,jr,Qr,O,Ce,null));let{left:de,top:be,width:Ne,height:De}=qt;Fp=de,Up=be,Op=Ne,kp=De}function zp(v,w,I,D,H,K,ae){qs=Hn._x=Hn._y=!1,qu(v,w,I,D,H,K,ae,!1,!0);let{left:de,top:be,width:Ne,height:De}=qt,Oe=Ne>0||De>0,at=Fp!=de||Up!=be||Op!=Ne||kp!=De;if(Oe&&at&&Cl(qt),Hn.setScale&&Oe&&at){let Tt=de,St=Ne,yt=be,je=De;if(L.ori==1&&(Tt=be,St=De,yt=de,je=Ne),Fn&&$s(M,us(Tt,M),us(Tt+St,M)),Un)for(let We in S){let $t=S[We];We!=M&&$t.from==null&&$t.min!=zt&&$s(We,us(yt+je,We),us(yt,We))}Yu()}else ce.lock&&(ce._lock=!ce._lock,_r(w,!0,v!=null));v!=null&&(Tn(Wf,Zf),la(Wf,n,Xt,Qt,O,Ce,null))}function j_(v,w,I,D,H,K,ae){if(ce._lock)return;Qe(v);let de=qs;if(qs){let be=!0,Ne=!0,De=10,Oe,at;L.ori==0?(Oe=Fn,at=Un):(Oe=Un,at=Fn),Oe&&at&&(be=Xt<=De||Xt>=O-De,Ne=Qt<=De||Qt>=Ce-De),Oe&&be&&(Xt=Xt<jr?0:O),at&&Ne&&(Qt=Qt<Qr?0:Ce),_r(null,!0,!0),qs=!1}Xt=-10,Qt=-10,ne.fill(null),_r(null,!0,!0),de&&(qs=de)}function Vp(v,w,I,D,H,K,ae){ce._lock||(Qe(v),sa(),Yu(),v!=null&&la(py,n,Xt,Qt,O,Ce,null))}function Gp(){A.forEach(pA),U(n.width,n.height,!0)}Hr(gu,$o,Gp);let no={};no.mousedown=Bp,no.mousemove=Dp,no.mouseup=zp,no.dblclick=Vp,no.setSeries=(v,w,I,D)=>{let H=vn.match[2];I=H(n,w,I),I!=-1&&hs(I,D,!0,!1)},pe&&(bt(uy,g,Bp),bt(Hf,g,Dp),bt(dy,g,v=>{Qe(v),aa(!1)}),bt(fy,g,j_),bt(py,g,Vp),ip.add(n),n.syncRect=aa);let Pl=n.hooks=i.hooks||{};function On(v,w,I){Qn?Nt.push([v,w,I]):v in Pl&&Pl[v].forEach(D=>{D.call(null,n,w,I)})}(i.plugins||[]).forEach(v=>{for(let w in v.hooks)Pl[w]=(Pl[w]||[]).concat(v.hooks[w])});let Hp=(v,w,I)=>I,vn=wn({key:null,setSeries:!1,filters:{pub:Ty,sub:Ty},scales:[M,x[1]?x[1].scale:null],match:[Ey,Ey,Hp],values:[null,null]},ce.sync);vn.match.length==2&&vn.match.push(Hp),ce.sync=vn;let Wp=vn.key,Zu=S_(Wp);function la(v,w,I,D,H,K,ae){vn.filters.pub(v,w,I,D,H,K,ae)&&Zu.pub(v,w,I,D,H,K,ae)}Zu.sub(n);function Q_(v,w,I,D,H,K,ae){vn.filters.sub(v,w,I,D,H,K,ae)&&no[v](null,w,I,D,H,K,ae)}n.pub=Q_;function ev(){Zu.unsub(n),ip.delete(n),Dn.clear(),jf(gu,$o,Gp),c.remove(),ye?.remove(),On("destroy")}n.destroy=ev;function Ku(){On("init",i,e),ia(e||i.data,!1),F[M]?Gu(M,F[M]):sa(),ie=qt.show&&(qt.width>0||qt.height>0),ee=fe=!0,U(i.width,i.height)}return x.forEach(qr),A.forEach(bs),t?t instanceof HTMLElement?(t.appendChild(c),Ku()):t(n,Ku):Ku(),n}Xn.assign=wn;Xn.fmtNum=hp;Xn.rangeNum=yu;Xn.rangeLog=xu;Xn.rangeAsinh=lp;Xn.orient=Xr;Xn.pxRatio=At;Xn.join=rE;Xn.fmtDate=dp,Xn.tzDate=gE;Xn.sync=S_;{Xn.addGap=jE,Xn.clipGaps=Mu;let i=Xn.paths={points:R_};i.linear=P_,i.stepped=tA,i.bars=nA,i.spline=sA}function Xe(i){let e=document.getElementById(i);if(e===null)throw new Error(`the page has no #${i}`);return e}function Se(i,e={},...t){let n=document.createElement(i);for(let[s,r]of Object.entries(e))typeof r=="function"?n.addEventListener(s.replace(/^on/,""),r):typeof r=="boolean"?n.toggleAttribute(s,r):n.setAttribute(s,r);return n.append(...t),n}function Jt(i,e){i.textContent!==e&&(i.textContent=e)}var vp="http://www.w3.org/2000/svg";function xp(i,e=!1){let t=document.createElementNS(vp,"svg");t.setAttribute("viewBox","0 0 24 24"),t.setAttribute("aria-hidden","true");let n=document.createElementNS(vp,"path");return n.setAttribute("d",i),e&&n.setAttribute("class","fill"),t.append(n),t}function Au(i,e){let t=document.createElementNS(vp,i);for(let[n,s]of Object.entries(e))t.setAttribute(n,s);return t}var Gn={play:"M7 5l12 7-12 7z",pause:"M8 5v14M16 5v14",step:"M6 5l9 7-9 7zM18 5v14",back:"M18 5l-9 7 9 7zM6 5v14",reset:"M4 12a8 8 0 108-8M4 4v5h5",record:"M12 6a6 6 0 100 12 6 6 0 000-12z",snapshot:"M12 8v5l3 2M4 12a8 8 0 108-8 8 8 0 00-7 4M4 4v4h4",picture:"M4 7h4l2-2h4l2 2h4v12H4zM12 10a3 3 0 100 6 3 3 0 000-6z",save:"M12 4v11M7 11l5 5 5-5M4 20h16",saveExact:"M4 13C8 3 14 13 20 4M12 9v8M8 13l4 4 4-4M4 21h16",loop:"M17 3l4 4-4 4M21 7H7a4 4 0 00-4 4M7 21l-4-4 4-4M3 17h14a4 4 0 004-4"};var bp=[{name:"force",title:"Force",unit:"N",least:.1},{name:"depth",title:"Depth",unit:"mm",least:.1},{name:"energy",title:"Energy",unit:"mJ",least:.01},{name:"loop",title:"Tick time",unit:"ms",least:.1}],mA=80,gA="palpate",Sp=class{constructor(e,t,n,s){this.about=e;this.tall=t;this.last=n;this.owner=s;this.root=Se("div",{class:"chart","data-chart":e.name},Se("div",{class:"head"},Se("h2",{},e.title," "),Se("span",{class:"unit"},e.unit),this.values),this.plot)}about;tall;last;owner;root;values=Se("span",{class:"values"});plot=Se("div",{class:"plot"});chart=null;shape="";data={time:[],lines:[]};height(){return this.tall()+(this.last?18:0)}set(e,t,n){this.data=e;let s=this.plot.clientWidth;if(s<40)return;let r=`${e.lines.map(({label:a})=>a).join()} ${e.band!==void 0} ${n.light} ${s} ${this.height()}`;r!==this.shape&&(this.shape=r,this.chart?.destroy(),this.chart=new Xn(this.options(e,s,n),this.table(),this.plot),this.values.replaceChildren(...e.lines.map(({label:a,colour:l})=>{let c=Se("span",{"data-line":a});return c.style.setProperty("--c",n.colour(l)),c})));let{chart:o}=this;o!==null&&(o.batch(()=>{o.setData(this.table(),!1),o.setScale("x",{min:t[0],max:t[1]}),o.setScale("y",this.heights(t))}),this.tell(o.cursor.idx??null))}table(){let{time:e,lines:t,band:n}=this.data,s=n===void 0?[]:[n.high,n.low];return[e,...t.map(({values:r})=>r),...s]}heights([e,t]){let[n,s]=[0,this.about.least],{time:r,lines:o,band:a}=this.data;for(let c of[...o.map(h=>h.values),...a===void 0?[]:[a.high]])for(let h=0;h<r.length;h++){let d=c[h];r[h]<e||r[h]>t||d===null||!Number.isFinite(d)||(d<n&&(n=d),d>s&&(s=d))}let l=.07*(s-n);return{min:n<0?n-l:0,max:s+l}}options({lines:e,band:t},n,s){let r={stroke:s.colour("muted"),grid:{stroke:s.colour("line"),width:1},ticks:{show:!1},font:"11px system-ui, sans-serif"};return{width:n,height:this.height(),legend:{show:!1},padding:[4,6,0,0],scales:{x:{time:!1},y:{auto:!1}},axes:[{...r,size:this.last?18:3,gap:2,space:60,values:(o,a)=>a.map(l=>this.last?`${Number(l.toFixed(6))} s`:"")},{...r,size:42,gap:3,space:22,values:(o,a)=>a.map(l=>String(Number(l.toPrecision(6))))}],bands:t===void 0?[]:[{series:[e.length+1,e.length+2],fill:`${s.colour(t.colour)}55`}],series:[{},...e.map(({label:o,colour:a,thin:l})=>({label:o,stroke:s.colour(a),width:l===!0?1:1.8,points:{show:!1},spanGaps:!0})),...t===void 0?[]:[{width:0,points:{show:!1}},{width:0,points:{show:!1}}]],cursor:{sync:{key:gA,setSeries:!1},drag:{x:this.owner.onZoom!==null,y:!1,setScale:!1},points:{size:6}},hooks:{setCursor:[o=>this.tell(o.cursor.idx??null)],draw:[o=>this.drawMark(o,s)],setSelect:[o=>{let{left:a,width:l}=o.select;l>4&&this.owner.onZoom?.(o.posToVal(a,"x"),o.posToVal(a+l,"x")),o.setSelect({left:0,top:0,width:0,height:0},!1)}],ready:[o=>{o.over.addEventListener("click",()=>{let a=o.cursor.left??-1;a>=0&&this.owner.onPick?.(o.posToVal(a,"x"))}),o.over.addEventListener("dblclick",()=>this.owner.onZoom?.(0,0))}]}}}drawMark(e,t){let{mark:n}=this.owner;if(n===null)return;let s=e.valToPos(n,"x",!0),{left:r,top:o,width:a,height:l}=e.bbox;s<r||s>r+a||(e.ctx.save(),e.ctx.strokeStyle=t.colour("accent"),e.ctx.lineWidth=1.5*devicePixelRatio,e.ctx.beginPath(),e.ctx.moveTo(s,o),e.ctx.lineTo(s,o+l),e.ctx.stroke(),e.ctx.restore())}tell(e){let{time:t,lines:n}=this.data,s=e??t.length-1;if(e===null&&this.owner.mark!==null)for(;s>0&&t[s]>this.owner.mark+1e-9;)s-=1;n.forEach(({label:r,values:o},a)=>{let l=this.values.children[a],c=o[s];l!==void 0&&Jt(l,`${n.length>1?`${r} `:""}${c==null?"–":Vs(c,3)}`)})}},Ru=class{onPick=null;onZoom=null;mark=null;charts;last=0;constructor(){let e=()=>innerWidth<=820?92:Math.round(Math.min(Math.max((innerHeight-538)/4,58),150));this.charts=bp.map((t,n)=>new Sp(t,e,n===bp.length-1,this)),Xe("charts").append(...this.charts.map(({root:t})=>t))}due(e){return e-this.last<mA?!1:(this.last=e,!0)}set(e,t,n){this.charts.forEach((s,r)=>s.set(e[bp[r].name],t,n))}};function os(i,e,t,n,s,r=!1){return Se("button",{id:i,type:"button",title:t,"aria-label":e,onclick:s},xp(n,r),Se("span",{class:"long"},` ${e}`))}var D_=i=>Se("div",{class:"group push"},os("save-picture","Picture","Save the picture as PNG (P)",Gn.picture,()=>i.picture()),os("save-net","OBJ","Save the surfaces as OBJ, triangles (O)",Gn.save,()=>i.nets()),os("save-step","STEP","Save the surfaces as STEP, exact (E)",Gn.saveExact,()=>i.step())),Tl=[.01,.05,.1,.25,.5,1,2,5,10],Cu=class{constructor(e,t,n,s){this.live=e;this.world=t;this.notices=n;let r=os("reset","Reset","Back to the start of the scene (backspace)",Gn.reset,()=>this.reset()),o=os("snapshot","Snapshot","Write the last seconds to a recording (K)",Gn.snapshot,()=>this.snapshot());this.acting=[this.pauseButton,this.stepButton,r,this.recordButton,o],this.speed.addEventListener("change",()=>e.speed(Number(this.speed.value))),Xe("deck").replaceChildren(Se("div",{class:"group"},this.pauseButton,this.stepButton,r),this.speed,Se("div",{class:"group"},this.recordButton,o),this.why,D_(s))}live;world;notices;pauseButton=os("pause","Pause","Pause or resume (space)",Gn.pause,()=>this.pause());stepButton=os("step","Step","One tick, while paused (.)",Gn.step,()=>this.step());recordButton=os("record","Record","Record, or stop recording (R)",Gn.record,()=>this.record(),!0);why=Se("span",{class:"why"});speed=Se("select",{id:"speed","aria-label":"Speed in lockstep",title:"Simulated to real time"},...Tl.map(e=>Se("option",{value:String(e),selected:e===1},`× ${e}`)));acting;async ask(e,t,n){let s=await this.live.call(e,t),r=s.ok?n(String(s.path??"")):`Refused (${e.replace("_"," ")}): ${s.error??"no reason given"}`;r!==null&&this.notices.tell(r,!s.ok)}get paused(){return this.world.status?.state==="Paused"}pause=()=>{this.ask(this.paused?"resume":"pause",{},()=>null)};step=()=>{this.ask("step",{ticks:1},()=>null)};reset=()=>{this.ask("reset",{},()=>null)};snapshot=()=>{this.ask("snapshot",{before:10,after:0},e=>`The last 10 seconds are in ${e}`)};record=()=>{this.world.status?.recorder==="Recording"?this.ask("record_stop",{},e=>`Recorded ${e}`):this.ask("record_start",{},e=>`Recording to ${e}`)};update(){let e=this.live.mayWrite;for(let n of this.acting)n.disabled=!e;this.speed.hidden=!this.live.lockstep,this.speed.disabled=!e,this.stepButton.disabled=!e||!this.paused;let t=this.world.status?.recorder==="Recording";this.relabel(this.pauseButton,this.paused?"Resume":"Pause",this.paused?Gn.play:Gn.pause),this.relabel(this.recordButton,t?"Stop":"Record",Gn.record),this.recordButton.classList.toggle("recording",t),this.recordButton.setAttribute("aria-pressed",String(t)),Jt(this.why,this.live.viewOnly?"This page is for looking only.":"")}relabel(e,t,n){if(e.getAttribute("aria-label")===t)return;e.setAttribute("aria-label",t);let s=e.querySelector("span");s!==null&&(s.textContent=` ${t}`),e.querySelector("path")?.setAttribute("d",n)}},Pu=class{constructor(e,t,n,s){this.playback=e;this.second=t;this.world=n;this.slider=Se("input",{id:"timeline",type:"range",min:String(e.first),max:String(e.last),step:"1","aria-label":"Time",oninput:()=>this.go(Number(this.slider.value))}),this.speed.addEventListener("change",()=>this.playback.speed=Number(this.speed.value)),Xe("deck").replaceChildren(Se("div",{class:"group"},os("back","Back","A tick back (,)",Gn.back,()=>this.stepBy(-1)),this.playButton,os("step","Step","A tick on (.)",Gn.step,()=>this.stepBy(1)),this.loopButton,this.speed),Se("div",{id:"track"},this.canvas,this.slider),this.time,D_(s));for(let r of Xe("deck").querySelectorAll("#back .long, #step .long, #pause .long"))r.remove()}playback;second;world;playButton=os("pause","Play","Play or pause (space)",Gn.play,()=>this.playback.toggle());loopButton=Se("button",{id:"loop",type:"button","aria-pressed":"false",title:"Play again at the end (L)","aria-label":"Loop",onclick:()=>this.toggleLoop()},xp(Gn.loop));speed=Se("select",{id:"speed","aria-label":"Speed"},...Tl.map(e=>Se("option",{value:String(e),selected:e===1},`× ${e}`)));time=Se("span",{class:"time"});slider;canvas=Se("canvas");drawn="";stepBy(e){this.playback.playing=!1,this.go(this.playback.tick+e)}go(e){this.playback.seek(e),this.second()?.seek(e)}toggleLoop(){this.playback.loop=!this.playback.loop,this.loopButton.setAttribute("aria-pressed",String(this.playback.loop))}faster(e){let t=Tl.indexOf(this.playback.speed)+e,n=Tl[Math.min(Math.max(t,0),Tl.length-1)];this.playback.speed=n,this.speed.value=String(n)}update(e){let{playback:t}=this,n=t.playing?"Pause":"Play";this.playButton.getAttribute("aria-label")!==n&&(this.playButton.setAttribute("aria-label",n),this.playButton.querySelector("path")?.setAttribute("d",t.playing?Gn.pause:Gn.play)),this.slider.value!==String(t.tick)&&(this.slider.value=String(t.tick));let s=r=>this.world.seconds(r);this.slider.setAttribute("aria-valuetext",`${fr(s(t.tick),3)} s, tick ${t.tick}`),Jt(this.time,`${fr(s(t.tick),3)} / ${fr(s(t.last),1)} s · tick ${t.tick}`),this.draw(e)}draw(e){let{canvas:t,playback:n}=this,{overview:s}=n,[r,o]=[t.clientWidth*devicePixelRatio,t.clientHeight*devicePixelRatio],a=`${r} ${o} ${s.version} ${n.tick} ${e.light}`;if(a===this.drawn||r===0)return;this.drawn=a,t.width=r,t.height=o;let l=t.getContext("2d");if(l===null)return;let c=Math.max(1,n.last-n.first),h=y=>(y-n.first)/c*(r-2)+1,d=Math.min(s.tools.length,6),u=o*.62/Math.max(d,1);for(let y=0;y<d;y++){l.fillStyle=e.colour("force"),l.globalAlpha=.75;for(let[p,m]of s.contactIntervals(y))l.fillRect(h(p),3+y*u,Math.max(1.5,h(m+1)-h(p)),Math.max(2,u-3))}l.globalAlpha=1;let f=s.tools.reduce((y,{size:p})=>p.reduce((m,x)=>Math.max(m,x),y),0);if(f>0){l.strokeStyle=e.colour("text"),l.lineWidth=devicePixelRatio,l.beginPath();for(let y=0;y<s.rows;y++){if(s.filled[y]===0)continue;let p=s.tools.reduce((m,x)=>Math.max(m,x.size[y]),0);l.lineTo(h(s.tickOf(y)),o*.7-o*.62*p/f)}l.stroke()}for(let y of this.world.events)l.fillStyle=e.colour(y.serious?"bad":"muted"),l.fillRect(h(y.tick)-devicePixelRatio/2,o*.76,2*devicePixelRatio,o*.24);l.fillStyle=e.colour("accent");let g=h(n.tick);l.fillRect(g-devicePixelRatio,0,2*devicePixelRatio,o),l.beginPath(),l.arc(g,5*devicePixelRatio,5*devicePixelRatio,0,7),l.fill()}};var yA=200,El=class{constructor(e){this.onPick=e;this.filter.addEventListener("change",()=>this.seen=-1)}onPick;list=Xe("events");filter=Xe("event-filter");seen=-1;update(e){let t=this.filter.value;if(this.seen===e.eventVersion)return;this.seen=e.eventVersion;let n=({about:o,serious:a})=>t==="all"||(t==="serious"?a:o===t),r=e.events.filter(n).slice(-yA).reverse().map(({tick:o,text:a,serious:l})=>{let c=`${fr(e.seconds(o))}`,h=this.onPick===null?Se("time",{},c):Se("button",{type:"button",title:"Go there",onclick:()=>this.onPick?.(o)},c);return Se("li",l?{class:"serious"}:{},h,Se("span",{},a))});this.list.replaceChildren(...r.length>0?r:[Se("li",{class:"none"},"Nothing so far.")])}};var F_=[["drag a tool","move it: the loop answers with a force"],["wheel meanwhile","push it along the view (second finger up and down)"],["Shift meanwhile","grip what it touches"],["Ctrl meanwhile","turn the tool"],["drag elsewhere","turn the view (one finger)"],["right drag","move the view (two fingers)"],["wheel","zoom (pinch)"]],_A=[["Space","pause, resume"],[".","one tick, while paused"],["R","record, stop"],["Backspace","reset the scene"],["K","keep the last seconds (snapshot)"],["T","take the chosen tool, let go"],["[ ]","choose the tool before, after"],["arrows","while held: move it; else turn the view"],["PgUp PgDn","while held: push away, pull"],["G","while held: grip on, off"],["Esc","let go"]],vA=[["Space","play, pause"],[", .","a tick back, on"],["< >","a tenth of a second back, on"],["Home End","beginning, end"],["Alt - +","slower, faster"],["L","play again at the end"],["[ ]","choose the tool before, after"]],xA=[["F","fit to the scene"],["0 1 2 3","oblique, front, side, top"],["+ -","zoom"],["V","view panel"],["N","control nets"],["B","cells inside bodies"],["C","next colouring"],["D","light, dark, as the system"],["U","sound"],["P","save the picture (PNG)"],["O","save the surfaces (OBJ)"],["E","save the surfaces (STEP)"],["?","this help"]];function Mp(i,e,t=!0){let n=Se("dl");for(let[s,r]of e){let o=t?s.split(" ").map(a=>Se("kbd",{},a)):[Se("span",{},s)];n.append(Se("dt",{},...o.flatMap((a,l)=>l>0?[" ",a]:[a])),Se("dd",{},r))}return Se("section",{},Se("h3",{},i),n)}var Iu=class{dialog=Xe("help");constructor(e,t){Xe("help-open").addEventListener("click",()=>this.open(e(),t())),this.dialog.addEventListener("click",n=>{n.target===this.dialog&&this.dialog.close()})}open(e,t){if(this.dialog.open)return this.dialog.close();this.dialog.replaceChildren(Se("button",{class:"close",type:"button",onclick:()=>this.dialog.close()},"Close"),Se("h2",{id:"help-title"},"Keys and mouse"),Se("div",{class:"columns"},Se("div",{},Mp("Mouse and fingers",e?F_.slice(4):F_,!1),Mp("Picture",xA)),Se("div",{},Mp(e?"Recording":"Loop and tools",e?vA:_A))),Se("p",{class:"why"},t===""?"":`Palpate ${t}`)),this.dialog.showModal()}};var bA=[["surface","surfaces"],["lines","lines"],["net","nets"],["lattice","cells"],["contacts","contacts"],["tools","tools"],["hands","hands"],["forces","forces"],["torques","torques"],["labels","numbers"],["grid","ground"],["shadows","shadows"]],SA={iso:[.85,-1,.55],front:[0,-1,.02],side:[1,0,.02],top:[0,-.02,1]},wp=i=>SA[i],Lu=class{constructor(e,t,n){this.settings=e;Xe("fit").addEventListener("click",t);for(let o of this.panel.querySelectorAll("[data-view]"))o.addEventListener("click",()=>n(o.dataset.view));this.toggleButton.addEventListener("click",()=>this.toggle());let s=(o,a,l)=>{let c=Xe(o);c.addEventListener(a,()=>e.set(h=>l(h,c)))};s("colour-by","change",(o,{value:a})=>o.colourBy=a),s("map","change",(o,{value:a})=>o.map=a),s("clip","change",(o,{value:a})=>o.clip=a),s("clip-at","input",(o,{value:a})=>o.clipAt=Number(a)),s("clip-flip","change",(o,{checked:a})=>o.clipFlip=a),s("lock-range","change",(o,{checked:a})=>o.lockRange=a);let r=Xe("layers");for(let[o,a]of bA){let l=Se("input",{type:"checkbox","data-layer":o});l.addEventListener("change",()=>e.set(c=>c.layers[o]=l.checked)),this.boxes.set(o,l),r.append(Se("label",{class:"check"},l,a))}e.onChange(()=>this.show()),innerWidth<1e3&&this.toggle(!1),this.show()}settings;panel=Xe("look");toggleButton=Xe("look-toggle");onToggle=()=>{};boxes=new Map;get width(){return this.panel.hidden||this.panel.parentElement.clientWidth<640?0:this.panel.offsetWidth+12}toggle(e=this.panel.hidden){this.panel.hidden=!e,this.onToggle(),this.toggleButton.setAttribute("aria-expanded",String(e))}offerDifference(e){let t=Xe("colour-by").querySelector("option[value=difference]");t!==null&&(t.hidden=t.disabled=!e)}offerInside(e,t){let n=this.boxes.get("lattice"),s=Xe("colour-by").querySelector("option[value=stiffness]");if(n!==void 0&&n.disabled===e){n.disabled=!e;let r=n.parentElement;r!==null&&(r.title=e?"Nodes and cells inside bodies (B)":"Nodes are known of a running loop: recordings hold control nets")}s!==null&&(s.hidden=s.disabled=!t)}show(){let{value:e}=this.settings;Xe("colour-by").value=e.colourBy,Xe("map").value=e.map,Xe("clip").value=e.clip,Xe("clip-at").value=String(e.clipAt),Xe("clip-flip").checked=e.clipFlip,Xe("lock-range").checked=e.lockRange;for(let t of["clip-at","clip-flip"])Xe(t).disabled=e.clip==="off";for(let[t,n]of this.boxes)n.checked=e.layers[t]}};var MA=9e3,wA=4,Nu=class{area=Xe("notices");lasting=new Map;tell(e,t=!1){for(let s of this.area.querySelectorAll("p:not([data-lasting])"))s.textContent===e&&s.remove();let n=Se("p",t?{class:"bad"}:{},e);for(this.area.append(n),requestAnimationFrame(()=>setTimeout(()=>n.remove(),MA));this.area.querySelectorAll("p:not([data-lasting])").length>wA;)this.area.querySelector("p:not([data-lasting])")?.remove()}keep(e,t){let n=this.lasting.get(e);if(t===null)n?.remove(),this.lasting.delete(e);else if(n===void 0){let s=Se("p",{class:"bad","data-lasting":e},t);this.lasting.set(e,s),this.area.prepend(s)}else n.textContent!==t&&(n.textContent=t)}};var TA=[["x",[1,0,0]],["y",[0,1,0]],["z",[0,0,1]]],EA=12,Du=class{root=Xe("gizmo");parts=TA.map(([e,t])=>{let n=Au("line",{x1:"0",y1:"0",stroke:`var(--${e})`}),s=Au("text",{fill:`var(--${e})`});s.textContent=e;let r=Au("g",{});return r.append(n,s),{axis:t,line:n,text:s,group:r}});update(e){let{right:t,up:n,away:s}=e.axes(),r=(a,l)=>a[0]*l[0]+a[1]*l[1]+a[2]*l[2],o=this.parts.map(a=>({...a,depth:r(a.axis,s)})).sort((a,l)=>l.depth-a.depth);for(let{axis:a,line:l,text:c,group:h}of o){let[d,u]=[r(a,t),-r(a,n)];l.setAttribute("x2",String(30*d)),l.setAttribute("y2",String(30*u)),c.setAttribute("x",String(41*d)),c.setAttribute("y",String(41*u)),this.root.append(h)}}},Fu=class{area=Xe("labels");spans=[];update(e,t,n,s){let r=[...n];if(s.layers.labels&&s.layers.forces)for(let{tools:o,group:a}of t){let l=o.filter(({tool:c,arrow:h})=>h.group.visible&&kt(c.force)>.005);for(let{tool:c,arrow:h}of l.slice(0,EA)){let{x:d,y:u,z:f}=h.tip.clone().add(a.position);r.push({text:kr(kt(c.force)),kind:"force",place:[d,u,f]})}}for(;this.spans.length<r.length;){let o=Se("span");this.spans.push(o),this.area.append(o)}this.spans.forEach((o,a)=>{let l=r[a],c=l===void 0?null:e.project(l.place),{clientWidth:h,clientHeight:d}=this.area,u=c!==null&&c.x>-20&&c.y>-10&&c.x<h+20&&c.y<d+30;if(o.hidden=!u,!u||l===void 0)return;Jt(o,l.text),o.className=l.kind;let f=Math.min(Math.max(c.x+8,4),h-66),g=Math.min(Math.max(c.y-24,2),d-26);o.style.transform=`translate(${f.toFixed(1)}px, ${g.toFixed(1)}px)`})}},Uu=class{root=Xe("legend");title=Se("div");map=Se("div",{class:"map"});low=Se("span");middle=Se("span");high=Se("span");scale=Se("div",{},this.title,this.map,Se("div",{class:"ends"},this.low,this.middle,this.high));arrow=Se("div",{class:"arrow"});ground=Xe("ground");constructor(){this.root.append(this.scale,this.arrow)}update(e,t,n){let{scale:s}=e;if(this.scale.hidden=s===null,s!==null){let o=pr(Math.max(Math.abs(s.from),s.to)),[a,l]=s.unit==="Pa"?o>=1e6?[1e-6,"MPa"]:o>=1e3?[.001,"kPa"]:[1,"Pa"]:s.unit!=="m"?[1,s.unit]:o>=.5?[1,"m"]:o>5e-5?[1e3,"mm"]:[1e6,"µm"];Jt(this.title,`${s.label}, ${l}`),this.map.style.backgroundImage=G0(s.map),Jt(this.low,Vs(s.from*a,2)),Jt(this.middle,Vs((s.from+s.to)/2*a,2)),Jt(this.high,Vs(s.to*a,2))}let r=e.tools.some(({arrow:o})=>o.group.visible);this.arrow.hidden=!n.layers.forces||!r,Jt(this.arrow,`Force, 1 N = ${ns(e.arrowScale,"m")}`),this.root.hidden=this.scale.hidden&&this.arrow.hidden,this.ground.hidden=!n.layers.grid||e.bodies.length===0,Jt(this.ground,`grid ${ns(t.cell,"m").replace(/\.0+ /," ")}`)}};var AA=[{name:"time",label:"time"},{name:"rate",label:"rate"},{name:"late",label:"late"},{name:"forces",label:"forces lost"},{name:"tick",label:"p99",minor:!0},{name:"quality",label:"quality",minor:!0},{name:"recorder",label:"",minor:!0}],RA=2e3,Tp=i=>i<1e4?i.toLocaleString("en"):`${Math.round(i/1e3)}k`,Ou=class{values=new Map;link=Xe("link");scene=Xe("scene-name");before={tick:0,at:0,hz:0};constructor(){let e=Xe("status");for(let{name:t,label:n,minor:s}of AA){let r=Se("b"),o=Se("span",{"data-item":t,...s===!0?{class:"minor"}:{}},r,` ${n}`);this.values.set(t,{item:o,value:r}),e.append(o)}}update(e,t){Jt(this.scene,e.name);let n=t===null&&e.link==="live"&&e.status!==null&&performance.now()-e.heard>RA;if(this.link.dataset.state=n?"lost":e.link==="live"&&e.status?.state==="Paused"?"paused":e.link,Jt(this.link,n?"No answer":this.linkWords(e,t)),this.put("time",`${fr(e.seconds())} s`),t!==null){this.put("rate",`× ${Vs(t.speed,2)}`,"speed"),this.put("late",`${(t.last-t.first+1).toLocaleString("en")}`,"ticks"),this.put("tick",t.recording.build.split(" source")[0],""),this.put("quality","",""),this.put("recorder","",""),this.put("forces","");return}let{status:s}=e;if(s===null)return;this.put("rate",`${s.rate_hz.toFixed(0)} Hz`,this.slower(e,s.rate_hz));let r=ns(Number(s.wait.p50_ns)*1e-9,"s");this.explain("rate",s.followed_tool===""?"Ticks on a fixed grid of time":`Ticks follow the poses of ${s.followed_tool}, which wait ${r}`);let[o,a]=[Number(s.late_ticks),Number(s.skipped_ticks)];this.put("late",Tp(o),a>0?`late, ${Tp(a)} skipped`:"late",a>0?"warn":""),this.forces(s),this.put("tick",ns(Number(s.step.p99_ns)*1e-9,"s")),this.explain("tick","Tick time: 99 of 100 ticks take less");let l=s.quality_level;this.put("quality",l===0?"full":`−${l}`,"quality",l>0?"warn":""),this.explain("quality",l===0?"Full quality":`Quality level ${l}: ${Bf[l]??""}`),this.explain("late",`${o} ticks began late, ${a} were skipped`);let c=s.recorder==="Failed"||s.recorder_drops>0n,h=s.recorder==="Recording"?` ${Jh(Number(s.recorder_bytes))}`:"",d=s.recorder_drops>0n?`, ${s.recorder_drops} records lost`:"";this.put("recorder",s.recorder==="Off"&&!c?"":`${Q0[s.recorder]}${h}${d}`,"",c?"bad":"")}forces(e){let t=e.tools.filter(r=>r.forces_overtaken+r.forces_lost>0n),n=t.reduce((r,o)=>r+Number(o.forces_overtaken+o.forces_lost),0);this.put("forces",n===0?"":Tp(n),"forces lost","warn");let s=({tool:r,forces_sent:o,forces_overtaken:a,forces_lost:l})=>`${r}: ${a} were not sent, a newer one was there; ${l} of ${o} sent were lost on the way`;this.explain("forces",t.map(s).join(`
`))}slower(e,t){let n=performance.now(),s=(n-this.before.at)*.001;s>=1&&(this.before={tick:e.tick,at:n,hz:(e.tick-this.before.tick)/s});let{hz:r}=this.before;return e.status?.state!=="Running"||e.lockstep||!(r>0)||r>.93*t?e.lockstep?"lockstep":"":`now ${r.toFixed(0)}`}linkWords(e,t){if(t!==null)return t.playing?"Playing":"Recording";switch(e.link){case"connecting":return"Connecting …";case"lost":return"No connection";case"failed":return"Failed";default:return e.status?.state==="Paused"?"Paused":e.status?.state==="Stopping"?"Stopping":"Live"}}explain(e,t){let n=this.values.get(e)?.item;n!==void 0&&n.title!==t&&(n.title=t)}put(e,t,n,s=""){let r=this.values.get(e);if(r!==void 0){if(Jt(r.value,t),n!==void 0){let o=r.item.lastChild;o!==null&&o!==r.value&&o.textContent!==` ${n}`&&(o.textContent=` ${n}`)}r.item.classList.toggle("warn",s==="warn"),r.item.classList.toggle("bad",s==="bad"),r.item.hidden=t===""}}};var U_=matchMedia("(prefers-color-scheme: dark)");function O_(i){U_.addEventListener("change",i)}function Ep(i){let e=i==="dark"||i==="system"&&U_.matches;document.documentElement.dataset.theme=e?"dark":"light";let t=getComputedStyle(document.documentElement),n=new Map;return{light:!e,colour(s){let r=n.get(s);return r===void 0&&n.set(s,r=t.getPropertyValue(`--${s}`).trim()),r}}}var ku=class{constructor(e){this.actions=e}actions;area=Xe("tools");buttons=new Map;built=-1;update(e,t){this.built!==e.sceneVersion&&(this.built=e.sceneVersion,this.buttons=new Map,this.area.replaceChildren(...e.tools.map(n=>this.make(n))),this.area.hidden=e.tools.length===0);for(let n of e.tools){let s=this.buttons.get(n.id);s!==void 0&&(Jt(s.value,kr(kt(n.force))),s.button.setAttribute("aria-pressed",String(t.has(n.id))),s.button.classList.toggle("held",n.holder!==null),s.button.title=`${n.shape}${n.holder===null?"":`, held by ${n.holder}`}. Shift: chart several`)}}make(e){let t=Se("span",{class:"n"}),n=Se("button",{type:"button","data-tool":e.id,"aria-pressed":"false",onclick:s=>this.actions.choose(e.id,s.shiftKey||s.ctrlKey)},e.id,t);return this.buttons.set(e.id,{button:n,value:t}),n}},Bu=class{size=Se("b",{"data-value":"force"});name=Se("span",{class:"name"});gauge=Se("i");values=new Map;words=Se("p",{class:"words"});take=Se("button",{type:"button",id:"take"},"Take with keys (T)");who=Se("span",{class:"who"});tool="";held=!1;constructor(e){let t=Se("dl");for(let[n,s]of[["fx","x"],["depth","depth"],["fy","y"],["energy","energy"],["fz","z"],["contacts","contacts"]]){let r=Se("dd");this.values.set(n,r),t.append(Se("dt",{},s),r)}this.take.addEventListener("click",()=>this.held?e.letGo():e.take(this.tool)),Xe("readout").append(Se("div",{class:"big"},this.size,Se("span",{class:"unit"},"N"),this.words,this.name),Se("div",{class:"gauge"},this.gauge),t,Se("div",{class:"actions",id:"actions"},this.take,this.who))}update(e,t,n,s){if(Xe("readout").hidden=e===void 0,e===void 0)return;this.tool=e.id,this.held=s;let r=kt(e.force);Jt(this.size,Number.isFinite(r)?r.toFixed(2):"–"),Jt(this.name,`on ${e.id}`),this.gauge.style.transform=`scaleX(${Math.min(r/(e.forceMax>0&&Number.isFinite(e.forceMax)?e.forceMax:10),1)||0})`,this.gauge.parentElement?.setAttribute("title",e.forceMax>0&&Number.isFinite(e.forceMax)?`of at most ${e.forceMax} N`:"of 10 N"),this.put("fx",kr(e.force[0])),this.put("fy",kr(e.force[1])),this.put("fz",kr(e.force[2])),this.put("depth",ns(e.depth,"m")),this.put("energy",ns(e.energy,"J")),this.put("contacts",String(e.contacts));let o=t&&!s&&e.holder===null;Jt(this.words,j0(e.flags,o).join(", ")),this.take.hidden=!n,Jt(this.take,s?"Let go (Esc)":"Take with keys (T)"),Jt(this.who,s?"you hold it":e.holder!==null?`held by ${e.holder}`:o?"nobody holds it":"")}put(e,t){let n=this.values.get(e);n!==void 0&&Jt(n,t)}};var k_=["size","x","z","y","second","force"];function CA(i,e,t){let n=-1;return i.map(s=>{for(;n+1<e.length&&e[n+1]<=s;)n+=1;return n<0?null:t[n]})}function B_(i,e){let[t]=i;if(t===void 0){let a={time:[],lines:[]};return{force:a,depth:a,energy:a,loop:e}}let{time:n}=t,s=a=>a.fx.map((l,c)=>Math.hypot(l,a.fy[c],a.fz[c]));if(i.length>1){let a=l=>({time:n,lines:i.map((c,h)=>({label:c.id,colour:k_[h%k_.length],values:CA(n,c.time,l(c))}))});return{force:a(s),depth:a(l=>l.depth.map(c=>1e3*c)),energy:a(l=>l.energy.map(c=>1e3*c)),loop:e}}let r=s(t),o=a=>r.map((l,c)=>Math.max(0,l+a*t.error[c]));return{force:{time:n,band:{colour:"size",low:o(-1),high:o(1)},lines:[{label:"size",colour:"size",values:r},{label:"x",colour:"x",values:t.fx,thin:!0},{label:"y",colour:"y",values:t.fy,thin:!0},{label:"z",colour:"z",values:t.fz,thin:!0}]},depth:{time:n,lines:[{label:"depth",colour:"force",values:t.depth.map(a=>1e3*a)}]},energy:{time:n,lines:[{label:"work",colour:"z",values:t.energy.map(a=>1e3*a)},{label:"taken away",colour:"second",values:t.dissipated.map(a=>1e3*a)}]},loop:e}}function z_(i,e,t){let n=i.tick-t/i.dt,s=u=>{let[f,g]=[0,u.length];for(;f<g;){let y=f+g>>>1;u[y]<n?f=y+1:g=y}return Math.max(0,f-1)},r=i.tools.filter(u=>e.has(u.id)).map(({id:u,history:f})=>{let g=s(f.ticks),[y,p,m,x,A,S,R]=f.columns.map(M=>M.slice(g));return{id:u,time:f.ticks.slice(g).map(M=>M*i.dt),fx:y,fy:p,fz:m,depth:x,energy:A,dissipated:S,error:R}}),o=s(i.loop.ticks),[a,l,,c]=i.loop.columns.map(u=>u.slice(o).map(f=>1e3*f)),[h]=r,d=1e3*i.dt;return B_(h===void 0?[]:r,{time:i.loop.ticks.slice(o).map(u=>u*i.dt),lines:[{label:"median",colour:"z",values:a},{label:"p99",colour:"size",values:l},{label:"late",colour:"force",values:c.map(u=>Math.max(0,u-d)),thin:!0}]})}function V_(i,e){let{dt:t,toolIds:n}=i.recording,s=[];for(let l=0;l<i.rows;l++)i.filled[l]===1&&s.push(l);let r=s.map(l=>i.tickOf(l)*t),o=l=>s.map(c=>l[c]),a=n.flatMap((l,c)=>{let h=i.tools[c];return!e.has(l)||h===void 0?[]:[{id:l,time:r,fx:o(h.fx),fy:o(h.fy),fz:o(h.fz),depth:o(h.depth),energy:o(h.energy),dissipated:o(h.dissipated),error:o(h.error)}]});return B_(a,{time:r,lines:[{label:"tick",colour:"size",values:o(i.step).map(l=>1e3*l)},{label:"late",colour:"force",values:o(i.late).map(l=>1e3*l),thin:!0}]})}var PA=66,IA=.2,zu=class{settings=new ru;notices=new Nu;look;stage=null;live=null;hand=null;playback=null;liveDeck=null;playbackDeck=null;theme;world=new Wo;views=[];second=null;pointer=null;chosen=new Set;focus=null;hovered=null;touched=!1;version="";range=null;status=new Ou;toolList;readout;charts=new Ru;events=new El(null);gizmo=new Du;labels=new Fu;legend=new Uu;help;sound=new ou;drawnVersions="";sceneName="";instancesListed="";lastFrame=0;lastWords=0;frames=0;fps=0;fpsSince=0;drawnLast=!1;firstPicture=0;updating=0;constructor(){this.theme=Ep(this.settings.value.theme),this.look=new Lu(this.settings,()=>this.fit(),s=>this.lookFrom(s));let e={choose:(s,r)=>this.choose(s,r),take:s=>this.take(s),letGo:()=>this.hand?.letGo()};this.toolList=new ku(e),this.readout=new Bu(e),this.help=new Iu(()=>this.playback!==null,()=>this.version),this.startStage(),this.bindPage(),Zp(this);let t=Se("select",{"aria-label":"Seconds shown"},...[5,10,30,60].map(s=>Se("option",{value:String(s),selected:s===this.settings.value.span},`${s} s`)));t.addEventListener("change",()=>this.settings.set(s=>s.span=Number(t.value)));let n=Se("label",{id:"span"},"Last ",t);Xe("actions").append(n),requestAnimationFrame(s=>this.frame(s))}get size(){return this.views[0]?.size??.1}startStage(){let e=Xe("view");try{this.stage=new jh(e)}catch{this.say("No picture","This browser has no WebGL, which the picture in three dimensions needs. Charts, values and controls work all the same."),e.hidden=!0,Xe("gizmo").toggleAttribute("hidden",!0),this.look.toggle(!1);return}let{stage:t}=this,n=()=>t.resize(e.clientWidth,e.clientHeight,this.look.width);this.look.onToggle=n,new ResizeObserver(n).observe(e),n(),e.addEventListener("webglcontextlost",s=>{s.preventDefault(),this.notices.keep("webgl","The graphics were lost; they come back by themselves.")}),e.addEventListener("webglcontextrestored",()=>{this.notices.keep("webgl",null),this.drawnVersions="",t.ask()})}bindPage(){this.settings.onChange(()=>this.applySettings()),O_(()=>this.applySettings()),Xe("theme").addEventListener("click",()=>this.settings.set(n=>n.theme=this.theme.light?"dark":"light")),Xe("sound").addEventListener("click",()=>this.settings.set(n=>n.sound=!n.sound)),this.applySettings(),document.addEventListener("visibilitychange",()=>{document.hidden&&(this.hand?.end(null),this.sound.update(0))});let e=Xe("drop"),t=n=>n.dataTransfer?.types.includes("Files")??!1;addEventListener("dragover",n=>{t(n)&&(n.preventDefault(),e.hidden=!1)}),addEventListener("dragleave",n=>{n.relatedTarget===null&&(e.hidden=!0)}),addEventListener("drop",n=>{n.preventDefault(),e.hidden=!0,this.openFiles([...n.dataTransfer?.files??[]])})}applySettings(){let{value:e}=this.settings;this.theme=Ep(e.theme),this.sound.set(e.sound),Xe("sound").setAttribute("aria-pressed",String(e.sound)),this.stage?.setPalette({grid:this.theme.colour("grid"),light:this.theme.light}),this.stage?.setGrid(e.layers.grid),this.stage?.setShadows(e.layers.shadows&&e.layers.grid),this.setClip(),this.drawnVersions=""}setClip(){let{clip:e,clipAt:t,clipFlip:n}=this.settings.value,s=this.world.bounds();if(this.stage===null||e==="off"||s.empty)return;let r={x:0,y:1,z:2}[e],o=n?1:-1,a=s.low[r]+t*(s.high[r]-s.low[r]);this.stage.clip.normal.set(r===0?o:0,r===1?o:0,r===2?o:0),this.stage.clip.constant=-o*a,this.stage.ask()}async start(){let e=Y0();if(e!==null){let n=e.tools===null?null:e.tools,s=new ca(e.bytes);return this.show([await this.opened(e.name,s,async()=>e.scene,async()=>n)])}let t=await fl();if(t===null){if(!location.protocol.startsWith("http"))return this.say("No recording","Drop a recording (.mcap) on this page to see it.");this.world.link="lost",this.notices.keep("link","The daemon does not answer; trying again …"),setTimeout(()=>{this.start()},1e3);return}if(this.notices.keep("link",null),this.version=t.version??"",this.warnOfOpen(t.open??[]),t.mode==="view")return this.openSession(t);this.goLive(t)}warnOfOpen(e){let t=Xe("open-network"),n=`Everybody who reaches ${e.join(", ")} can move tools and give commands.`;t.hidden=e.length===0,t.title=n,t.onclick=()=>this.notices.tell(n,!0)}goLive(e){this.leave(),document.body.dataset.mode="live";let t=new lu(this.world,e);this.live=t;let n=new hu(this.world,t,()=>this.size);this.hand=n,n.onEnd=(s,r)=>{this.pointer?.drop(),r!==null&&this.notices.tell(`${s}: ${r}`,!0)},t.onOpen=()=>n.end("the connection was lost"),t.onRefused=(s,r)=>{let o=/^tool\/([^/]+)\//.exec(s)?.[1];o!==void 0&&n.tool?.id===o?n.end(r):this.notices.tell(r,!0)},this.addView(this.world),this.liveDeck=new Cu(t,this.world,this.notices,{picture:()=>this.savePicture(),nets:()=>this.saveNets(),step:()=>this.saveStep()}),this.stage!==null&&this.pointer===null&&(this.pointer=new uu(this.stage,n,()=>this.views[0]?.tools??[]),this.pointer.enabled=()=>this.live?.mayHold??!1,this.pointer.onHover=s=>this.hovered=s,this.pointer.onTake=s=>this.take(s)),t.start()}async openSession(e){let t=e.recordings??[];if(t.length===0)return this.say("No recordings","There is none to show here. Drop one (.mcap) on this page.");let n=t.filter(s=>s.against===!0);if(n.length>0)return this.openLinks([t.find(s=>s.against!==!0)??t[0],n[0]]);if(t.length===1)return this.openLinks(t);this.offer(t),await this.openLinks([t[0]])}offer(e){let t=Xe("instances"),n=t.querySelector("select");n!==null&&(t.firstChild?.replaceWith("Recording "),n.replaceChildren(...e.map(({name:s,bytes:r},o)=>Se("option",{value:String(o)},r===void 0?s:`${s} (${Jh(r)})`))),n.addEventListener("change",()=>{this.openLinks([e[Number(n.value)]])}),t.hidden=!1)}async openLinks(e){let t=async s=>{if(s==null)return null;let r=await fetch(s);return r.ok?r:null},n=async s=>{let r=await t(s.scene_url);return r===null?null:new Uint8Array(await r.arrayBuffer())};await this.tryShow(()=>Promise.all(e.map(async s=>this.opened(s.name,await Kp(s.url),()=>n(s),async()=>(await t(s.tools_url))?.text()??null,async()=>(await t(s.inside_url))?.json()??null))))}async openFiles(e){let t=e.filter(({name:n})=>/\.mcap(\.part)?$/.test(n)).slice(0,2);if(t.length===0){e.length>0&&this.notices.tell(`${e[0].name} is not a recording (.mcap)`,!0);return}await this.tryShow(()=>Promise.all(t.map(n=>this.opened(n.name,new Nl(n),async()=>null,async()=>null))))}async opened(e,t,n,s,r=async()=>null){let o=await Wl.open(e,t,n),a=[];try{a=JSON.parse(await o.attachmentText("tools.json")??await s()??"[]")}catch{o.warnings.push("the shapes of its tools cannot be read")}let l=[];try{l=Xl(await r())}catch{}return{recording:o,outlines:a,insides:l}}async tryShow(e){try{this.show(await e())}catch(t){let n=t instanceof Error?t.message:String(t);this.playback===null&&this.live===null?this.say("This recording cannot be shown",n):this.notices.tell(n,!0)}}show(e){this.leave(),document.body.dataset.mode="recording",Xe("empty").hidden=!0,Xe("span").hidden=!0;let[t,n]=e;if(this.playback=new yl(t.recording,this.world,t.outlines),this.world.setInsides(t.insides),this.addView(this.world),n!==void 0){let a=new Wo;this.second=new yl(n.recording,a,n.outlines),a.setInsides(n.insides),this.addView(a)}for(let{recording:a}of e)for(let l of a.warnings)this.notices.tell(`${a.name}: ${l}`,!0);let s=new Set(e.map(({recording:a})=>a.build));s.size>1&&this.notices.tell(`The two are of different builds: ${[...s].join("; ")}`),this.look.offerDifference(n!==void 0),n!==void 0&&this.settings.set(a=>a.colourBy="difference");let{playback:r}=this;this.playbackDeck=new Pu(r,()=>this.second,this.world,{picture:()=>this.savePicture(),nets:()=>this.saveNets(),step:()=>this.saveStep()});let o=a=>this.playbackDeck?.go(a);this.events=new El(o),this.charts.onPick=a=>o(Math.round(a/r.recording.dt)),this.charts.onZoom=(a,l)=>this.range=l>a?[a,l]:null,r.seek(r.first)}leave(){this.hand?.end(null),this.live?.stop(),this.playback?.stop(),this.second?.stop();for(let e of this.views)e.dispose();this.views=[],this.live=this.hand=this.playback=this.second=this.liveDeck=this.playbackDeck=null,this.world=new Wo,this.chosen.clear(),this.focus=this.range=null,this.sceneName="",this.drawnVersions="",this.look.offerDifference(!1),this.settings.value.colourBy==="difference"&&this.settings.set(e=>e.colourBy="displacement")}addView(e){this.stage!==null&&this.views.push(new su(e,this.stage))}say(e,t){let n=Xe("empty");n.replaceChildren(Se("h2",{},e),Se("p",{},t)),n.hidden=!1}choose(e,t){t||this.chosen.clear(),t&&this.chosen.has(e)&&this.chosen.size>1?this.chosen.delete(e):this.chosen.add(e),this.focus=this.chosen.has(e)?e:[...this.chosen][0]??null,this.settings.version+=1,this.drawnVersions=""}chooseNext(e){let{tools:t}=this.world;if(t.length===0)return;let n=t.findIndex(({id:s})=>s===this.focus);this.choose(t[(n+e+t.length)%t.length].id,!1)}take(e){let t=this.world.tool(e);if(!(t===void 0||this.hand===null)){if(this.choose(e,!1),this.live?.mayHold!==!0){let n=this.live?.viewOnly===!0?"This page is for looking only.":this.live?.mayWrite===!0?"The tools of a recording move by themselves.":"There is no connection to the daemon.";this.notices.tell(n,!0);return}this.touched=!0,this.hand.take(t)}}takeOrLetGo(){if(this.hand?.state==="holding")this.hand.letGo();else{let e=this.world.tool(this.focus??"")??this.world.tools[0];e!==void 0&&this.take(e.id)}}frameOf(){let[e,t]=this.views;if(e===void 0)return{middle:[0,0,0],size:.1};if(t===void 0)return{middle:e.middle,size:e.size};let n=t.group.position;return{middle:yi(e.middle,Ut([n.x,n.y,n.z],.5)),size:1.55*e.size}}fit(){let{middle:e,size:t}=this.frameOf();this.stage?.fit(e,t,null)}lookFrom(e){let{middle:t,size:n}=this.frameOf();this.stage?.fit(t,n,wp(e))}savePicture(){this.stage?.png(this.theme.colour("ground")).then(e=>{e!==null&&$l(Yl(this.world,"png"),e)})}saveNets(){$l(Yl(this.world,"obj"),new Blob([Rm(this.world)],{type:"model/obj"}))}saveStep(){let e=this.world.bodies.flatMap(n=>fd(n)??[]),t=Lm(this.world);t!==null&&$l(Yl(this.world,"step"),new Blob([t],{type:"model/step"})),(e.length>0||t===null)&&this.notices.tell(`Not in the file: ${e.join("; ")||"there is no body"}`,!0)}showHelp(){this.help.open(this.playback!==null,this.version)}lookOf(){let e=t=>this.theme.colour(t);return{tool:this.theme.light?"#4b87b8":"#5f9bcd",focus:this.theme.light?"#1f78c8":"#49a7f5",hand:e("text"),force:e("force"),torque:e("second"),contact:this.theme.light?"#0b1b2b":"#fff6c9"}}frame(e){requestAnimationFrame(o=>this.frame(o));let t=e-this.lastFrame;if(this.lastFrame=e,this.playback!==null){this.playback.advance(t);let{second:o,playback:a}=this;o!==null&&(o.advance(0),o.tick!==a.tick&&a.playing&&o.seek(a.tick))}if(this.focus===null||this.world.tool(this.focus)===void 0){let o=this.world.tools[0]?.id;o!==void 0&&this.choose(o,!1)}this.lookInside();let n=`${this.world.version} ${this.second?.world.version??0} ${this.settings.version} ${this.theme.light}`,s=n!==this.drawnVersions;if(this.drawnVersions=n,s){let o=performance.now();this.updateViews(),this.updating+=.1*(performance.now()-o-this.updating)}let r=this.stage?.draw()??!1;r&&this.drawnLast&&this.stage?.pace(t),this.drawnLast=r,r&&(this.frames+=1),r&&this.firstPicture===0&&(this.views[0]?.bodies.length??0)>0&&(this.firstPicture=performance.now()),e-this.fpsSince>1e3&&([this.fps,this.frames,this.fpsSince]=[1e3*this.frames/(e-this.fpsSince),0,e]),(s||r)&&this.updateOverlay(),e-this.lastWords>PA&&(this.lastWords=e,this.updateWords()),this.charts.due(e)&&this.updateCharts()}lookInside(){let{layers:e,colourBy:t}=this.settings.value;this.live?.lookInside(e.lattice&&this.stage!==null,t==="stiffness")}updateViews(){let{stage:e,views:t}=this,n=Math.max(0,...this.world.tools.map(h=>kt(h.force)/(Number.isFinite(h.forceMax)&&h.forceMax>0?h.forceMax:10))),s=this.playback===null?this.world.link==="live":this.playback.playing;if(this.sound.update(s?n:0),e===null)return;let r=this.lookOf(),o=t.map(h=>h.rebuild(r))[0]??!1,a=t.map((h,d)=>h.update(this.settings.value,this.settings.version,r,this.focus,t.length===2?t[1-d]:null)),[l,c]=t;if(l!==void 0&&c!==void 0){let[h,d]=this.firstDirection(l);c.group.position.set(...Ut([-d,h,0],.9*l.size/Math.hypot(h,d)))}o&&l!==void 0&&l.bodies.length+l.tools.length>0&&this.setScene(l,e),a.includes(!0)&&e.ask()}setScene(e,t){let{middle:n,size:s}=this.frameOf();t.setScene(n,s,e.groundZ),this.setClip(),!(this.sceneName===this.world.name||e.bodies.length===0)&&(t.fit(n,s,this.firstDirection(e),this.sceneName!==""),this.sceneName=this.world.name)}firstDirection(e){let[t]=this.world.tools,[n]=this.world.bodies,s=wp("iso");if(t===void 0||n===void 0||this.world.tools.length>4)return s;let r=new ci().take(n.rest).middle,[o,a]=[t.proxy[0]-r[0],t.proxy[1]-r[1]];if(!(Math.hypot(o,a)>.15*e.size))return s;let c=Math.atan2(-o,a)+IA;return[Math.cos(c),Math.sin(c),.36]}updateOverlay(){let{stage:e}=this,[t]=this.views;e===null||t===void 0||(this.gizmo.update(e),this.labels.update(e,this.views,this.titles(),this.settings.value),this.legend.update(t,e,this.settings.value),e.canvas.toggleAttribute("data-held",this.hand?.state==="holding"),e.canvas.toggleAttribute("data-over",this.hovered!==null))}titles(){if(this.second!==null&&this.playback!==null)return this.views.map((t,n)=>{let{x:s,y:r,z:o}=t.group.position,a=[this.playback,this.second].map(c=>c?.recording.name??"");return{text:a[0]===a[1]?`${a[n]} (${n+1})`:a[n],kind:"title",place:[t.middle[0]+s,t.middle[1]+r,t.groundZ+o]}});let e=this.hovered===null||this.hand?.state==="holding"?void 0:this.world.tool(this.hovered);return e===void 0?[]:[{text:e.holder===null?e.id:`${e.id}, held by ${e.holder}`,kind:"title",place:e.proxy}]}updateWords(){let{world:e,live:t}=this;this.status.update(e,this.playback),this.toolList.update(e,this.chosen);let n=this.hand?.state!==void 0&&this.hand.state!=="free"&&this.hand.tool?.id===this.focus;this.readout.update(this.focus===null?void 0:e.tool(this.focus),e.link==="live",t?.mayHold??!1,n),this.events.update(e),this.liveDeck?.update(),this.playbackDeck?.update(this.theme),t!==null?(this.notices.keep("link",e.link==="lost"?e.trouble:null),this.showInstances(e.instances,t.instance)):e.trouble!==""&&this.notices.keep("trouble",e.trouble);let s=e.bodies.flatMap(({fault:r})=>r===null?[]:[r]);this.notices.keep("nets",s.length===0?null:`Not drawn: ${s.slice(0,3).join("; ")}${s.length>3?` and ${s.length-3} more`:""}`),this.look.offerInside(t!==null,t!==null||e.insides.length>0),this.updateHint()}showInstances(e,t){let n=Xe("instances");n.hidden=e.length<2;let s=n.querySelector("select"),{pages:r}=this.live??{pages:{}},o=e.map(a=>`${a} ${r[a]??""}`).join();s===null||this.instancesListed===o||(this.instancesListed=o,s.replaceChildren(...e.map(a=>Se("option",{value:a,selected:a===t,disabled:a!==t&&r[a]===void 0},a))),s.onchange=()=>{let a=this.live?.pages[s.value];a!==void 0&&/^https?:/.test(a)&&(location.href=a)})}updateHint(){let e=Xe("hint"),t=this.focus===null?void 0:this.world.tool(this.focus),n=this.live?.mayHold===!0&&this.stage!==null&&t!==void 0,s="";n&&this.hand?.state==="holding"?s=matchMedia("(pointer: coarse)").matches?"Second finger up or down: push along the view":"Wheel: push along the view · Shift: grip":n&&!this.touched?s=`Drag the ${t.id.replace(/[_-]/g," ")} to press`:this.live?.mayWrite===!0&&this.world.status?.state==="Paused"&&(s="Paused: space runs on"),e.hidden=s==="",e.textContent!==s&&(e.textContent=s)}updateCharts(){let{playback:e,world:t}=this;if(e!==null){let n=[t.seconds(e.first),t.seconds(e.last)];this.charts.mark=t.seconds(e.tick),this.charts.set(V_(e.overview,this.chosen),this.range??n,this.theme)}else if(this.live!==null){let{span:n}=this.settings.value,s=t.seconds();this.charts.set(z_(t,this.chosen,n),[Math.max(0,s-n),Math.max(s,n)],this.theme)}}report(){let{world:e,stage:t}=this,n=s=>({id:s.id,force:[...s.force],depth:s.depth,proxy:[...s.proxy],holder:s.holder,hand:s.hand?.position??null,poseAgeMs:s.poseAgeMs,rows:s.history.ticks.length,screen:t?.project(s.proxy)??null});return{link:e.link,tick:e.tick,scene:e.name,malformed:this.live?.malformed??0,firstPictureMs:this.firstPicture,updateMs:this.updating,fps:this.fps,costMs:t?.cost??null,thrifty:t?.thrifty??!1,coarse:t?.coarse??!1,bodies:e.bodies.map(s=>({id:s.id,nodes:s.nodes===null?0:s.nodes.length/3,points:s.points.length/3,netTick:s.netTick,fault:s.fault,assumed:s.assumed})),extents:this.views.map(s=>s.bodies.map(({extent:r})=>r)),tools:e.tools.map(n),contacts:e.contacts.length,events:e.events.length,hand:this.hand?.state??null,playback:this.playback===null?null:{tick:this.playback.tick,first:this.playback.first,last:this.playback.last,playing:this.playback.playing,seekMs:this.playback.seekMs,overview:this.playback.overview.done,warnings:this.playback.recording.warnings,second:this.second?.tick??null}}}inside(e){let t=this.world.body(e);return{nodes:[...t?.nodes??[]],points:[...t?.points??[]]}}net(e){return[...this.world.body(e)?.points??[]]}};var G_=new zu;window.palpate=G_;G_.start();})();
