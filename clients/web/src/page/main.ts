import { App } from "./app";

declare global {
  interface Window {
    palpate: App;
  }
}

const app = new App();
window.palpate = app;
void app.start();
