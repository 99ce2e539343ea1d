// Requests to isotherm-web that a page could not make: without a cookie, with that of an ended session, from another origin, and streams
// that are not read. The certificate has to be that of the run.
import { Agent, request } from 'node:https';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect } from './check.mjs';

export const document = JSON.parse(readFileSync(join(process.env.WEB_CHECK_SOURCE, 'enroll/web/api/openapi.json')));

export class Api {
  // `base` is the origin of the server, `certificate` its certificate (PEM)
  constructor(base, certificate) {
    this.base = base;
    this.certificate = certificate;
    this.cookie = '';
  }

  // A further client without a cookie.
  other() {
    return new Api(this.base, this.certificate);
  }

  options(method, path, headers) {
    return {
      method,
      agent: new Agent({ keepAlive: false }),
      ca: this.certificate,
      checkServerIdentity: () => undefined, // the certificate is this one; its names do not matter
      headers: { origin: this.base, ...(this.cookie ? { cookie: this.cookie } : {}), ...headers },
    };
  }

  // {status, code, body, headers}. An `undefined` header is left out.
  ask(method, path, body, headers = {}) {
    const text = body === undefined ? undefined : typeof body === 'string' ? body : JSON.stringify(body);
    const all = { ...(text === undefined ? {} : { 'content-type': 'application/json', 'content-length': Buffer.byteLength(text) }), ...headers };
    return new Promise((resolve, reject) => {
      const options = this.options(method, path, all);
      for (const name of Object.keys(options.headers)) {
        if (options.headers[name] === undefined) {
          delete options.headers[name];
        }
      }
      const asked = request(`${this.base}/api/v1${path}`, options, (answer) => {
        const parts = [];
        if (/event-stream|octet-stream/.test(answer.headers['content-type'] ?? '')) {
          asked.destroy(); // a stream without an end
          resolve({ status: answer.statusCode, body: null, headers: answer.headers });
          return;
        }
        answer.on('data', (part) => parts.push(part));
        answer.on('error', reject);
        answer.on('end', () => {
          const bytes = Buffer.concat(parts).toString();
          const json = /json/.test(answer.headers['content-type'] ?? '') ? JSON.parse(bytes) : bytes;
          resolve({ status: answer.statusCode, code: json?.code, body: json, headers: answer.headers });
        });
      });
      asked.on('error', reject);
      asked.setTimeout(20000, () => asked.destroy(new Error(`${method} ${path}: no answer for 20 s`)));
      asked.end(text);
    });
  }

  async login(account, password) {
    const answer = await this.ask('POST', '/session', { account, password });
    expect(answer.status === 201, `a login as ${account} was expected to succeed: ${answer.status} ${answer.code}`);
    this.cookie = answer.headers['set-cookie'][0].split(';')[0];
    return answer;
  }

  // Opens a stream. on_bytes receives its bytes; without it nothing is read after the head of the answer.
  stream(path, onBytes) {
    return new Promise((resolve, reject) => {
      const asked = request(`${this.base}/api/v1${path}`, this.options('GET', path, {}), (answer) => {
        expect(answer.statusCode === 200, `GET ${path} was expected to answer 200, not ${answer.statusCode}`);
        let over = false;
        answer.on('error', () => undefined);
        answer.on('close', () => { over = true; });
        if (onBytes) {
          answer.on('data', onBytes);
        } else {
          answer.pause();
          answer.socket.pause();
        }
        resolve({ close: () => asked.destroy(), ended: () => over });
      });
      asked.on('error', reject);
      asked.end();
    });
  }
}

// Every request of the document: {method, path, least, roles}, with names that belong to nobody in the place of {name}.
export function operations() {
  const found = [];
  for (const [path, methods] of Object.entries(document.paths)) {
    for (const [method, operation] of Object.entries(methods)) {
      if (operation['x-least-role']) {
        found.push({ method: method.toUpperCase(), path: path.replace('{name}', 'nobody-of-this-name'), least: operation['x-least-role'], body: operation.requestBody !== undefined });
      }
    }
  }
  return found;
}
