"""The paper's figures and statements: settings, walks, statements, figures, and the command."""
