// The page as it opens: it plays, unless the system asks for little motion.
$("side").open = data.kind === "arm" && innerWidth > 900;
$("side").addEventListener("toggle", () => draw());
$("values").addEventListener("toggle", () => sliders());
offerOptions();
if (live) offerChanges();
const nothing = () => false, shownArm = data.kind === "arm" ? showArm() : null;
const handles = live && shownArm ? offerHandles(shownArm) : { pressed: nothing, dragged: nothing, clicked: nothing };
const camera = shownArm ? shownArm.camera : data.kind === "map" ? showMap() : null;
if (camera) listenTo(handles.pressed, handles.dragged, handles.clicked, camera);
sliders(); draw();
if (!matchMedia("(prefers-reduced-motion: reduce)").matches && data.path) play(true);
