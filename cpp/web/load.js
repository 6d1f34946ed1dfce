/** The core as a module with play, measure, notes, describe, effectMeaning and contactNames. */
async function loadCore() {
  const packed = Uint8Array.from(atob(CORE_WASM), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const wasmBinary = new Uint8Array(await new Response(stream).arrayBuffer());
  return stickslipCore({ wasmBinary });
}
