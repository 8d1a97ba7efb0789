/** Reads the two data elements of the page: JSON and binary, each gzip in base64. */
import type { Offset, ViewDocument } from "./document";

export const FORMAT = "foliate.view/1";

export class Arrays {
    constructor(private readonly bytes: ArrayBuffer) {}

    float32(offset: Offset, length: number): Float32Array {
        return new Float32Array(this.slice(offset, length * 4));
    }

    uint32(offset: Offset, length: number): Uint32Array {
        return new Uint32Array(this.slice(offset, length * 4));
    }

    uint16(offset: Offset, length: number): Uint16Array {
        return new Uint16Array(this.slice(offset, length * 2));
    }

    private slice(offset: Offset, length: number): ArrayBuffer {
        if (offset < 0 || offset + length > this.bytes.byteLength) {
            throw new Error(`the page is cut short: bytes ${offset} to ${offset + length} of ${this.bytes.byteLength}`);
        }
        return this.bytes.slice(offset, offset + length);
    }
}

async function inflate(id: string): Promise<ArrayBuffer> {
    const element = document.getElementById(id);
    const text = element?.textContent?.trim();
    if (!element || !text) throw new Error(`the page has no data: #${id} is empty`);
    const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    // The text is no longer needed, and may be megabytes.
    element.textContent = "";
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
}

export async function readPage(): Promise<{ view: ViewDocument; arrays: Arrays }> {
    const [json, binary] = await Promise.all([inflate("foliate-json"), inflate("foliate-binary")]);
    const view = JSON.parse(new TextDecoder().decode(json)) as ViewDocument;
    if (view.format !== FORMAT) throw new Error(`the data is of format ${view.format}; this page reads ${FORMAT}`);
    return { view, arrays: new Arrays(binary) };
}
