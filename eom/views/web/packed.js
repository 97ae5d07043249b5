/* Arrays that stand in a page as base64, little-endian: "f4", "f8" floats, "u2", "u4" whole numbers. */
"use strict";

const unpacked = (() => {
  const KINDS = {f4: Float32Array, f8: Float64Array, u2: Uint16Array, u4: Uint32Array};
  return (text, kind = "f4") => {
    const plain = atob(text);
    const found = new Uint8Array(plain.length);
    for (let k = 0; k < plain.length; k += 1) {
      found[k] = plain.charCodeAt(k);
    }
    return new KINDS[kind](found.buffer);
  };
})();
