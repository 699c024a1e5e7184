/** The worker that speaks the messages of `galewood/client`. Importing it in a worker starts it. */
import "./worker/forestWorker";
